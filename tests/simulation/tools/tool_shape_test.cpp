// Compares tools' balls with the exact shapes that they are fitted to. The gaps are measured at other points
// than those of the fit.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/solids/mesh_solid.h"
#include "simulation/tools/tool_kinds.h"
#include "simulation/tools/tool_mesh.h"
#include "tests/oracles/tool_quality.h"
#include "tests/simulation/mesh/mesh_shapes.h"

namespace osteon::simulation {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Whether both tools have equal balls in equal order, to the last bit.
bool SameBalls(const Tool& a, const Tool& b) {
  if (a.balls.size() != b.balls.size()) return false;
  for (std::size_t i = 0; i < a.balls.size(); ++i)
    if (Vector3(a.balls[i].center_m) != Vector3(b.balls[i].center_m) ||
        a.balls[i].radius_m != b.balls[i].radius_m || a.balls[i].cutting != b.balls[i].cutting)
      return false;
  return true;
}

// Signed distance in m from p to the union of the tool's cutting balls.
double GapAt(const Tool& tool, const Vector3& p_m) {
  double gap = 1.0;
  for (const ToolBall& ball : tool.balls)
    if (ball.cutting) gap = std::min(gap, (p_m - Vector3(ball.center_m)).norm() - ball.radius_m);
  return gap;
}

TEST(ToolProfile, DistancesOfAConeAndABallAreExact) {
  // a cone of 90 degrees, 10 mm wide, on a cylinder; distances by hand
  const ToolProfile cone(
      {{.back_z_m = -0.005, .back_r_m = 0.005, .gap_m = 1e-4},
       {.front_z_m = -0.005, .front_r_m = 0.005, .back_z_m = -0.030, .back_r_m = 0.005, .gap_m = 1e-4}});
  EXPECT_NEAR(cone.SignedDistance(Vector3(0, 0, 0.001)), 0.001, 1e-15);
  EXPECT_NEAR(cone.SignedDistance(Vector3(0, 0, -0.002)), -0.002 * std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(cone.SignedDistance(Vector3(0, 0.003, -0.015)), -0.002, 1e-15);
  EXPECT_NEAR(cone.SignedDistance(Vector3(0.009, 0, -0.015)), 0.004, 1e-15);
  EXPECT_NEAR(cone.SignedDistance(Vector3(0.004, 0, -0.001)), 0.003 * std::sqrt(0.5), 1e-15);
  // A ball of 5 mm on a thin neck: inside the ball, the distance is that to its sphere.
  const ToolProfile ball(
      {{.back_z_m = -0.009, .back_r_m = 0.003, .sphere_radius_m = 0.005, .sphere_z_m = -0.005, .gap_m = 1e-4},
       {.front_z_m = -0.009, .front_r_m = 0.003, .back_z_m = -0.03, .back_r_m = 0.003, .gap_m = 1e-4}});
  EXPECT_NEAR(ball.SignedDistance(Vector3(0.001, 0.002, -0.003)), -(0.005 - 0.003), 1e-15);
  EXPECT_NEAR(ball.SignedDistance(Vector3(0, 0.007, -0.005)), 0.002, 1e-15);
  EXPECT_NEAR(ball.SignedDistance(Vector3(0, 0, -0.005)), -0.005, 1e-15);
  EXPECT_NEAR(ball.SignedDistance(Vector3(0, 0.001, -0.02)), -0.002, 1e-15);
}

TEST(ToolProfile, RefusesOutlinesThatDoNotJoinRunForwardOrEncloseNothing) {
  const ProfilePiece cone{.back_z_m = -0.005, .back_r_m = 0.005, .gap_m = 1e-4};
  const auto with = [&](auto change) {
    ProfilePiece next{
        .front_z_m = -0.005, .front_r_m = 0.005, .back_z_m = -0.03, .back_r_m = 0.005, .gap_m = 1e-4};
    change(next);
    return ToolProfile({cone, next});
  };
  EXPECT_NO_THROW(with([](ProfilePiece&) {}));
  EXPECT_THROW(with([](ProfilePiece& p) { p.front_z_m = -0.006; }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.back_z_m = 0.0; }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.back_r_m = -0.001; }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.back_r_m = std::nan(""); }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.sphere_radius_m = 0.01; }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.metal_ratio = 0.0; }), std::invalid_argument);
  EXPECT_THROW(with([](ProfilePiece& p) { p.gap_m = 0.0; }), std::invalid_argument);
  EXPECT_THROW(ToolProfile({}), std::invalid_argument);
  EXPECT_THROW(ToolProfile({{.back_z_m = 0.0, .back_r_m = 0.005, .gap_m = 1e-4}}), std::invalid_argument);
}

TEST(RoundBurr, HeadIsOneExactBallAndTheThinnerNeckDoesNotCut) {
  for (const double d : {1.0e-3, 2.3e-3, 8.0e-3}) {
    BurrParams params{.diameter_m = d, .neck_diameter_m = std::min(0.55 * d, 2.35e-3)};
    const BuiltTool built = MakeBurr(params);
    const ToolQuality quality = MeasureTool(built.tool, *built.profile, built.profile->Sample(20'000, 7));
    EXPECT_EQ(quality.cutting_balls, 1u);
    EXPECT_LT(quality.cutting_gap_max_m, 1e-12);
    EXPECT_LE(quality.touching_gap_max_m, params.balls.touching_gap_m);
    EXPECT_LT(quality.protrusion_max_m, 1e-12);
    const ToolBall& head = built.tool.balls.front();
    EXPECT_EQ(head.radius_m, 0.5 * d);
    EXPECT_EQ(Vector3(head.center_m), Vector3(0, 0, -0.5 * d));
    for (const ToolBall& ball : built.tool.balls) {
      if (ball.cutting) continue;
      EXPECT_LT(ball.center_m.z + ball.radius_m, -0.5 * d) << "nothing else ahead of the head's centre";
    }
  }
}

TEST(PackedBurr, BallsFillTheOutlineToTheStatedGapAndNoneProtrudes) {
  for (const BurrShape shape :
       {BurrShape::kPear, BurrShape::kCylinder, BurrShape::kTaper, BurrShape::kFlatCylinder})
    for (const double gap_m : {0.05e-3, 0.1e-3}) {
      BurrParams params{
          .shape = shape, .diameter_m = 2.3e-3, .head_length_m = 5e-3, .tip_diameter_m = 1.2e-3};
      params.balls = {.max_count = 600, .cutting_gap_m = gap_m, .touching_gap_m = 0.15e-3};
      const BuiltTool built = MakeBurr(params);
      const ToolQuality quality = MeasureTool(built.tool, *built.profile, built.profile->Sample(30'000, 7));
      EXPECT_LE(quality.cutting_gap_max_m, gap_m) << built.tool.name << " " << built.tool.balls.size();
      EXPECT_LE(quality.touching_gap_max_m, 0.15e-3) << built.tool.name;
      EXPECT_LT(quality.protrusion_max_m, 1e-12) << built.tool.name;
      // the gap must not be much finer than requested, because that would waste balls
      EXPECT_GT(quality.cutting_gap_max_m, 0.5 * gap_m) << built.tool.name;
    }
}

TEST(PackedBurr, TwoHundredBallsReachAGapThatSixtyFourCannot) {
  BurrParams params{
      .shape = BurrShape::kTaper, .diameter_m = 2.3e-3, .head_length_m = 5e-3, .tip_diameter_m = 1.2e-3};
  params.balls = {.max_count = 200, .cutting_gap_m = 0.02e-3};
  const BuiltTool built = MakeBurr(params);
  EXPECT_LE(built.tool.balls.size(), 200u);
  EXPECT_LE(MeasureTool(built.tool, *built.profile, built.profile->Sample(30'000, 7)).cutting_gap_max_m,
            0.02e-3);
  params.balls.max_count = 64;
  EXPECT_THROW(static_cast<void>(MakeBurr(params)), std::invalid_argument);
}

TEST(TwistDrill, BallsFillThePointsConeToTheStatedGapAndNoneProtrudes) {
  TwistDrillParams params;
  params.balls = {.max_count = 100, .cutting_gap_m = 0.1e-3, .touching_gap_m = 0.5e-3};
  const BuiltTool built = MakeTwistDrill(params);
  const double R = 1.6e-3, half = 59.0 * kDegree, depth = R / std::tan(half);
  double worst = 0.0;
  // the cone by its own equation, r = z tan(59 deg), independent of the profile
  for (int i = 0; i <= 200; ++i)
    for (int k = 0; k < 97; ++k) {
      const double z = depth * i / 200.0, phi = 2.0 * std::numbers::pi * k / 97.0, r = z * std::tan(half);
      worst = std::max(worst, GapAt(built.tool, Vector3(r * std::cos(phi), r * std::sin(phi), -z)));
    }
  EXPECT_LE(worst, 0.1e-3);
  EXPECT_GT(worst, 0.0);
  // no ball leaves the cone, in any direction of the cone's normal
  for (const ToolBall& ball : built.tool.balls) {
    const double r = std::hypot(ball.center_m.x, ball.center_m.y), z = -ball.center_m.z;
    EXPECT_LE(ball.radius_m, (z * std::sin(half) - r * std::cos(half)) + 1e-12);
    EXPECT_LE(r + ball.radius_m, R + 1e-12);
  }
  EXPECT_NEAR(CuttingReach(built.tool), R, 1e-6);
}

TEST(TwistDrill, PointAndFlutesCutAndTheShankTouches) {
  const BuiltTool built = MakeTwistDrill({});
  const auto bounds_of = [&](bool cutting) {
    Eigen::AlignedBox3d box;
    for (const ToolBall& ball : built.tool.balls) {
      if (ball.cutting != cutting) continue;
      box.extend(Vector3(ball.center_m) - Vector3::Constant(ball.radius_m));
      box.extend(Vector3(ball.center_m) + Vector3::Constant(ball.radius_m));
    }
    return box;
  };
  const Eigen::AlignedBox3d cutting = bounds_of(true), touching = bounds_of(false);
  // The cutting balls end within the gap of the flutes' end. A ball there may reach beyond the flutes' end,
  // inside the tool.
  EXPECT_NEAR(cutting.max().z(), 0.0, 0.128e-3);
  EXPECT_NEAR(cutting.min().z(), -36e-3, 1.6e-3);
  EXPECT_NEAR(touching.max().z(), -36e-3, 1.6e-3);
  EXPECT_LT(touching.min().z(), -64e-3);
}

TEST(Fit, IsTheSameInEveryRun) {
  EXPECT_TRUE(SameBalls(MakeTwistDrill({}).tool, MakeTwistDrill({}).tool));
  BurrParams params{.shape = BurrShape::kPear, .head_length_m = 4e-3};
  EXPECT_TRUE(SameBalls(MakeBurr(params).tool, MakeBurr(params).tool));
}

TEST(Fit, TooFewBallsAreRefused) {
  TwistDrillParams params;
  params.balls.max_count = 20;
  try {
    static_cast<void>(MakeTwistDrill(params));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("greatest count: found 20, accepted more"), std::string::npos)
        << error.what();
  }
}

TEST(Kinds, ImpossibleSizesAreRefused) {
  const auto burr = [](auto change) {
    BurrParams p{
        .shape = BurrShape::kTaper, .diameter_m = 2e-3, .head_length_m = 5e-3, .tip_diameter_m = 1e-3};
    p.neck_diameter_m = 1e-3;
    change(p);
    return MakeBurr(p);
  };
  EXPECT_NO_THROW(burr([](BurrParams&) {}));
  EXPECT_THROW(burr([](BurrParams& p) { p.neck_diameter_m = 2e-3; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.tip_diameter_m = 3e-3; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.head_length_m = 1e-3; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.length_m = 8e-3; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.density_kg_per_m3 = 0.0; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.balls.max_count = 0; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.holder.length_m = -1.0; }), std::invalid_argument);
  EXPECT_THROW(burr([](BurrParams& p) { p.diameter_m = std::nan(""); }), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(MakeTwistDrill({.point_rad = 3.2})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(MakeTwistDrill({.flute_length_m = 0.5e-3})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(MakeReamer({.diameter_m = 0.016})), std::invalid_argument)
      << "the shaft is as wide";
  EXPECT_THROW(static_cast<void>(MakeReamer({.shell_m = 0.025})), std::invalid_argument);
}

// A mesh of a ball, packed with balls, against the exact ball.
TEST(MeshTool, ABallsMeshIsFilledToWithinGapAndFacets) {
  const double R = 3e-3;
  const TriangleMesh ball = MakeIcosphere(Vector3(0, 0, -R), R, 3);
  // the mesh's facets lie below the ball by up to R (1 - cos(half the edge's angle)): 25 um here
  const double facets_m = R * 0.0085, gap_m = 0.05e-3;
  MeshToolParams params{.cutting_back_z_m = -R};
  params.balls = {.max_count = 200, .cutting_gap_m = gap_m, .touching_gap_m = gap_m};
  Pose X = Pose::Identity();  // the highest vertex up, so that the apex is at z = 0
  X.linear() = Eigen::Quaterniond::FromTwoVectors(ball.vertices_m[0] - Vector3(0, 0, -R), Vector3::UnitZ())
                   .toRotationMatrix();
  TriangleMesh mesh = ball;
  for (Vector3& v : mesh.vertices_m) v = X.linear() * (v - Vector3(0, 0, -R)) + Vector3(0, 0, -R);
  const BuiltTool built = MakeMeshTool(mesh, params);
  double below = 0.0, above = 0.0;
  for (int i = 0; i < 2000; ++i) {  // the cutting half of the analytic ball, by a Fibonacci spiral
    const double z = (i + 0.5) / 2000.0, phi = i * 2.399963229728653, r = std::sqrt(1 - z * z);
    const double gap =
        GapAt(built.tool, R * Vector3(r * std::cos(phi), r * std::sin(phi), z) - Vector3(0, 0, R));
    below = std::max(below, gap);
    above = std::max(above, -gap);
  }
  EXPECT_LE(below, gap_m + facets_m);
  EXPECT_LE(above, 1e-9) << "a ball of the mesh lies in the ball";
  EXPECT_NEAR(CuttingReach(built.tool), R, gap_m + facets_m);
  bool touches = false;
  for (const ToolBall& b : built.tool.balls) touches |= !b.cutting;
  EXPECT_TRUE(touches) << "the back half does not cut";
  // mass: the mesh and its holder, from z = -2R back
  const MassProperties holder = CylinderMassProperties(
      params.holder.radius_m, -2 * R, -2 * R - params.holder.length_m, params.holder.density_kg_per_m3);
  const double ball_kg = 7900.0 * 4.0 / 3.0 * std::numbers::pi * R * R * R;
  EXPECT_NEAR(built.tool.mass_kg - holder.mass_kg, ball_kg, 0.02 * ball_kg);
}

TEST(MeshTool, ABoxIsFilledToTheGapAndWrongMeshesAreRefused) {
  const TriangleMesh box = MakeBox(Vector3(-4e-3, -3e-3, -20e-3), Vector3(4e-3, 3e-3, 0));
  MeshToolParams params{.name = "chisel", .cutting_back_z_m = -5e-3};
  params.balls = {.max_count = 500, .cutting_gap_m = 0.4e-3, .touching_gap_m = 1e-3};
  const BuiltTool built = MakeMeshTool(box, params);
  const MeshSolid solid(box);
  const ToolQuality quality = MeasureTool(built.tool, solid, SampleMesh(box, params, 20'000, 7));
  EXPECT_LE(quality.cutting_gap_max_m, 1.2 * 0.4e-3) << "beside the sharp edges";
  EXPECT_LE(quality.touching_gap_max_m, 1.2 * 1e-3);
  EXPECT_LT(quality.protrusion_max_m, 1e-9);

  const auto message = [&](auto change) -> std::string {
    TriangleMesh mesh = box;
    MeshToolParams p = params;
    change(mesh, p);
    try {
      static_cast<void>(MakeMeshTool(mesh, p));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message([](TriangleMesh& m, MeshToolParams&) {
              for (Vector3& v : m.vertices_m) v.z() += 2e-3;
            }).find("(the apex): found 2 mm"),
            std::string::npos);
  EXPECT_NE(message([](TriangleMesh&, MeshToolParams& p) {
              p.cutting_back_z_m = -0.5;
              p.cutting_front_z_m = -0.4;
            }).find("nothing of the mesh lies in z -500 … -400 mm"),
            std::string::npos);
  EXPECT_NE(message([](TriangleMesh&, MeshToolParams& p) { p.balls.max_count = 10; }).find("accepted more"),
            std::string::npos);
}

TEST(CuttingHead, IsTheForemostOfEquallyLargeCuttingBalls) {
  Tool tool;
  tool.balls = {{.center_m = Vector3(0, 0, -0.02), .radius_m = 0.0020001, .cutting = true},
                {.center_m = Vector3(0, 0, -0.01), .radius_m = 0.002, .cutting = true},
                {.center_m = Vector3(0, 0, -0.001), .radius_m = 0.001, .cutting = true},
                {.center_m = Vector3(0, 0, -0.03), .radius_m = 0.009, .cutting = false}};
  EXPECT_EQ(CuttingHead(tool), &tool.balls[1]);
  EXPECT_EQ(CuttingHead(Tool{}), nullptr);
}

}  // namespace
}  // namespace osteon::simulation
