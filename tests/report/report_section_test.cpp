#include "report/section.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "report_markup.h"
#include "report_synthetic.h"

namespace osteon::report {
namespace {

// Sum of the areas that the lines enclose: positive if a line runs counter-clockwise.
double Area(const std::vector<Polyline>& lines) {
  double area = 0.0;
  for (const Polyline& line : lines)
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Vector2 a = line.points[i], b = line.points[(i + 1) % line.points.size()];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
  return area;
}

TEST(Contour, ACircleHasItsAreaAndRunsCounterClockwise) {
  PlanarGrid grid({-2, -2}, {2, 2}, 0.05, 0.0f);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) grid.At(i, j) = static_cast<float>(grid.Node(i, j).norm() - 1.3);
  const auto lines = Contour(grid);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].closed);
  // chords of length h lie up to h^2/(8 r) inside an arc of radius r: at most 1e-4 of the area here
  EXPECT_NEAR(Area(lines), std::numbers::pi * 1.3 * 1.3, 3e-3)
      << "positive: counter-clockwise around the inside";
}

TEST(Contour, TheHoleOfARingCountsNegative) {
  PlanarGrid grid({-2, -2}, {2, 2}, 0.05, 0.0f);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i)
      grid.At(i, j) = static_cast<float>(std::abs(grid.Node(i, j).norm() - 1.0) - 0.3);
  EXPECT_EQ(Contour(grid).size(), 2u);
  EXPECT_NEAR(Area(Contour(grid)), std::numbers::pi * (1.3 * 1.3 - 0.7 * 0.7), 3e-3);
}

TEST(Contour, LinesThatLeaveTheGridStayOpen) {
  PlanarGrid grid({0, 0}, {1, 1}, 0.1, 0.0f);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) grid.At(i, j) = static_cast<float>(grid.Node(i, j).y() - 0.52);
  const auto lines = Contour(grid);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_FALSE(lines[0].closed);
  for (const Vector2& p : lines[0].points) EXPECT_NEAR(p.y(), 0.52, 1e-6);
}

TEST(Contour, EveryPatternOfCornersGivesClosedLines) {
  // all 2^9 patterns on 3×3 inner nodes with a closed border
  for (int pattern = 0; pattern < 512; ++pattern) {
    PlanarGrid grid({0, 0}, {4, 4}, 1.0, 1.0f);
    for (int k = 0; k < 9; ++k) grid.At(1 + k % 3, 1 + k / 3) = (pattern >> k & 1) != 0 ? -1.0f : 1.0f;
    double area = 0.0;
    for (const Polyline& line : Contour(grid)) ASSERT_TRUE(line.closed) << pattern;
    area = Area(Contour(grid));
    ASSERT_EQ(area > 0.0, pattern != 0) << pattern;
  }
}

TEST(SweptTool, DistanceToACapsuleIsExactOutside) {
  simulation::Tool tool;
  tool.balls = {{.center_m = Vector3(0, 0, -0.01), .radius_m = 0.01, .cutting = true},
                {.center_m = Vector3(0, 0, -0.05), .radius_m = 0.05, .cutting = false}};
  std::vector<Pose> path;
  for (int i = 0; i <= 100; ++i) {
    Pose X = Pose::Identity();
    X.translation() = Vector3(0.0004 * i, 0, 0.01);
    path.push_back(X);
  }
  const SweptTool swept(tool, path);
  EXPECT_NEAR(swept.SignedDistance({0.02, 0.015, 0.0}), 0.005, 1e-12);
  EXPECT_NEAR(swept.SignedDistance({-0.03, 0, 0}), 0.02, 1e-12);
  EXPECT_NEAR(swept.SignedDistance({0.07, 0, 0}), 0.02, 1e-12);
  EXPECT_NEAR(swept.SignedDistance({0.02, 0, 0}), -0.01, 1e-12);
  EXPECT_TRUE(std::isinf(SweptTool(tool, {}).SignedDistance(Vector3::Zero())));
}

TEST(BallField, FirstHitAndDepthAgreeWithAnalyticSphere) {
  std::vector<simulation::Ball> balls{{.center_m = Vector3(0.01, 0.002, -0.004), .radius_m = 0.003}};
  for (int i = 0; i < 200; ++i)
    balls.push_back({.center_m = Vector3(0.03 + 0.0001 * i, 0.0, 0.0), .radius_m = 0.0004});
  const BallField field(balls);
  const Vector3 d = Vector3(0.01, 0.002, -0.004).normalized();
  const auto hit = field.FirstHit(Vector3::Zero(), d, 1.0);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(*hit, Vector3(0.01, 0.002, -0.004).norm() - 0.003, 1e-12);
  EXPECT_FALSE(field.FirstHit(Vector3::Zero(), -d, 1.0).has_value());
  EXPECT_FALSE(field.FirstHit(Vector3::Zero(), d, 0.005).has_value()) << "farther than asked for";
  EXPECT_NEAR(field.Depth({0.01, 0.002, -0.003}), 0.002, 1e-12);
  EXPECT_LT(field.Depth(Vector3::Zero()), 0.0);
  EXPECT_FALSE(BallField({}).FirstHit(Vector3::Zero(), d, 1.0).has_value());
}

TEST(BallField, FirstHitAgreesWithBruteForceOnASyntheticCup) {
  const SyntheticRun run = MakeSyntheticRun(
      {.spacing_m = 2e-3, .cap_m = 1.8e-3, .point_spacing_m = 3e-3, .ticks = 1, .frames = 2});
  const BallField field(run.bone.balls);
  for (int i = 0; i < 500; ++i) {
    // directions on a spiral over the lower hemisphere, by the golden angle of 2.399963 rad
    const double a = 2.399963 * i, down = (i + 0.5) / 500.0, across = std::sqrt(1 - down * down);
    const Vector3 d(across * std::cos(a), across * std::sin(a), -down), o(0.001, -0.002, 0.003);
    double best = 1e9;
    for (const simulation::Ball& ball : run.bone.balls) {
      const Vector3 c = Vector3(ball.center_m) - o;
      const double disc = std::pow(c.dot(d), 2) - c.squaredNorm() + ball.radius_m * ball.radius_m;
      if (disc >= 0.0 && c.dot(d) > 0.0) best = std::min(best, c.dot(d) - std::sqrt(disc));
    }
    const auto hit = field.FirstHit(o, d, 1.0);
    ASSERT_EQ(hit.has_value(), best < 1e9) << i;
    if (hit) {
      EXPECT_NEAR(*hit, best, 1e-12) << i;
    }
  }
}

/// Makes a solid of balls on a fine lattice with a carved spherical cavity of radius `cavity_m`, and a tool
/// whose head of radius `tool_m` is at the cavity's centre. The cavity's error is then the difference of the
/// radii, plus the roughness of the balls.
SyntheticRun SphereCavity(double cavity_m, double tool_m) {
  SyntheticRun run;
  run.bone.site = {.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 0.004};
  const double spacing = 0.35e-3, radius = 0.34e-3;
  for (double z = -0.009; z < 0.0005; z += spacing)
    for (double y = -0.009; y < 0.009; y += spacing)
      for (double x = -0.009; x < 0.009; x += spacing)
        run.bone.balls.push_back({.center_m = Vector3(x, y, z), .radius_m = radius});
  std::vector<simulation::Ball> balls = run.bone.balls;
  Carve(balls, Vector3::Zero(), Vector3::Zero(), cavity_m);
  run.after = StateOf(balls);
  run.tool.balls = {{.center_m = Vector3(0, 0, 0), .radius_m = tool_m, .cutting = true}};
  return run;
}

TEST(CavityError, IsTheDifferenceOfTheRadiiForASphericalCavity) {
  const std::vector<Pose> path{Pose::Identity()};
  // The cutting model leaves each cut ball touching the cavity. Between balls of r = 0.34 mm at 0.35 mm
  // spacing the surface recedes by less than a third of r, on average by less than a fifth.
  const double rough_m = 0.07e-3;
  for (const double offset_m : {0.5e-3, 0.0, -0.5e-3}) {
    const SyntheticRun run = SphereCavity(0.006, 0.006 - offset_m);
    const Section section = ComputeSection(run.bone, run.after, run.tool, path, {.step_m = 0.05e-3});
    EXPECT_GT(section.error.samples, 100);
    EXPECT_GT(section.error.mean_m, offset_m - 2e-6) << offset_m;
    EXPECT_LT(section.error.mean_m, offset_m + rough_m) << offset_m;
    const CavityError error = CavityErrorByDirection(run.bone, run.after, run.tool, path);
    EXPECT_GT(error.samples, 2000);
    EXPECT_EQ(error.open, 0);
    EXPECT_GT(error.mean_m, offset_m - 2e-6) << offset_m;
    EXPECT_LT(error.mean_m, offset_m + rough_m) << offset_m;
    if (offset_m < 0.0) {
      EXPECT_LT(error.max_under_m, offset_m + rough_m);
      EXPECT_NEAR(error.mean_abs_m, std::abs(error.mean_m), 0.02e-3);
    }
  }
}

TEST(CavityError, BoneThatWasNotCutCountsByDirectionButNotInTheSection) {
  const std::vector<Pose> path{Pose::Identity()};
  SyntheticRun run = SphereCavity(0.006, 0.006);
  run.after = StateOf(run.bone.balls);
  // nothing was cut, so the bone has no cut surface to compare …
  EXPECT_EQ(ComputeSection(run.bone, run.after, run.tool, path).error.samples, 0);
  // … and in every direction all of the swept volume is still bone
  EXPECT_LT(CavityErrorByDirection(run.bone, run.after, run.tool, path).mean_m, -5e-3);
}

// A ball that reaches from the cavity to the bone's far face shrinks at both faces when it is cut. The loss
// at the far face is no error of the cavity's surface.
TEST(CavityError, TheFarFaceOfABallThatWasCutDoesNotCount) {
  SyntheticRun run;
  run.bone.site = {.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 0.004};
  for (double x = -0.012; x <= 0.012; x += 0.5e-3)
    for (double y = -0.012; y <= 0.012; y += 0.5e-3)
      run.bone.balls.push_back({.center_m = Vector3(x, y, -0.008), .radius_m = 0.004});
  std::vector<simulation::Ball> balls = run.bone.balls;
  Carve(balls, Vector3::Zero(), Vector3::Zero(), 0.006);
  run.after = StateOf(balls);
  run.tool.balls = {{.center_m = Vector3(0, 0, 0), .radius_m = 0.006, .cutting = true}};
  const Section section = ComputeSection(run.bone, run.after, run.tool, std::vector<Pose>{Pose::Identity()},
                                         {.depth_in_cup_radii = 4.0});
  EXPECT_GT(section.error.samples, 20);
  EXPECT_LT(section.error.max_over_m, 2e-3) << "the far face is 6 mm away from the sweep";
}

TEST(CavityError, DirectionsWithoutRemainingBoneCountAsOpen) {
  SyntheticRun run = SphereCavity(0.006, 0.006);
  for (float& value : run.after.balls) value = 0.0f;
  const CavityError error =
      CavityErrorByDirection(run.bone, run.after, run.tool, std::vector<Pose>{Pose::Identity()});
  EXPECT_EQ(error.samples, 0);
  EXPECT_GT(error.open, 1000);
}

TEST(Section, ACupCutByTheCuttingModelIsNearTheSweptTool) {
  const SyntheticRun run = MakeSyntheticRun({.tilt_rad = 0.17});
  const auto path = PathOf(run);
  const Section section = ComputeSection(run.bone, run.after, run.tool, path);
  EXPECT_GT(section.error.samples, 100);
  // The cutting model leaves no overlap: the remaining bone is outside the sweep, up to the grid's chords
  // (step^2 / 8r = 2 um) and the chords of a path that is cut in steps of five frames.
  EXPECT_GT(section.error.max_under_m, -0.03e-3);
  EXPECT_GT(section.error.mean_m, 0.0);
  EXPECT_LT(section.error.mean_m, 0.3e-3);
  EXPECT_EQ(section.materials.size(), 3u);
  EXPECT_NEAR(section.plane.u.dot(section.plane.v), 0.0, 1e-12);
  EXPECT_GT(section.head_radius_m, 0.0);
}

TEST(Section, ThePathInTheBonesFrameDoesNotDependOnTheBonesPose) {
  SyntheticRun run =
      MakeSyntheticRun({.spacing_m = 1.5e-3, .cap_m = 1.4e-3, .point_spacing_m = 1.5e-3, .frames = 100});
  const auto here = PathOf(run);
  Pose X_WG = Pose::Identity();
  X_WG.linear() = ExpRotation({0.3, -1.1, 0.7});
  X_WG.translation() = Vector3(0.4, -0.2, 0.9);
  for (simulation::FrameRecord& frame : run.frames) frame.model.X_WP = X_WG * Pose(frame.model.X_WP);
  const auto there = PathOf(run, X_WG);
  ASSERT_EQ(here.size(), there.size());
  for (std::size_t i = 0; i < here.size(); ++i) EXPECT_TRUE(here[i].isApprox(there[i], 1e-12));
}

// A drill of 2 mm radius goes 40 mm deep: the section's window reaches the hole's floor, and the detail shows
// it.
TEST(Section, ADeepHoleShowsItsFloor) {
  SyntheticRun run;
  run.bone.site = {.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 0.002};
  for (double z = -0.050; z < 0.0005; z += 0.7e-3)
    for (double y = -0.005; y <= 0.005; y += 0.7e-3)
      for (double x = -0.005; x <= 0.005; x += 0.7e-3)
        run.bone.balls.push_back({.center_m = Vector3(x, y, z), .radius_m = 0.68e-3});
  std::vector<simulation::Ball> balls = run.bone.balls;
  Carve(balls, Vector3::Zero(), Vector3(0, 0, -0.040), 0.002);
  run.after = StateOf(balls);
  run.tool.balls = {{.center_m = Vector3(0, 0, 0), .radius_m = 0.002, .cutting = true}};
  std::vector<Pose> path(2, Pose::Identity());
  path[1].translation().z() = -0.040;
  const Section section = ComputeSection(run.bone, run.after, run.tool, path);
  EXPECT_LT(section.min.y(), -0.042);
  EXPECT_GT(section.min.y(), -0.060) << "no farther than the bone";
  double lowest_m = 0.0;
  for (const ErrorSample& sample : section.samples) lowest_m = std::min(lowest_m, sample.place_m.y());
  EXPECT_NEAR(lowest_m, -0.042, 0.7e-3) << "the floor is measured as well";
  const SweptTool swept(run.tool, path);
  for (const ErrorSample& sample : section.samples)
    ASSERT_NEAR(swept.SignedDistance(section.plane.Point(sample.place_m)), sample.error_m, 1e-9);
  EXPECT_NE(SectionDetailSvg(section, run.bone).find("Detail at the deepest place"), std::string::npos);
}

// After the cut the tool moved out of the bone. The detail must show the place of the cut, not the tool's
// last place.
TEST(Section, DetailOfACutThatTheToolLeftIsWhereTheCutIs) {
  SyntheticRun run = SphereCavity(0.006, 0.006);
  std::vector<Pose> path(2, Pose::Identity());
  path[1].translation().z() = -0.060;  // far below the bone, which ends at -9 mm
  const Section section = ComputeSection(run.bone, run.after, run.tool, path);
  ASSERT_FALSE(section.samples.empty());
  const std::string svg = SectionDetailSvg(section, run.bone);
  ASSERT_NE(svg.find("Detail of the cut"), std::string::npos);
  const Vector2 middle = section.samples[section.samples.size() / 2].place_m;
  EXPECT_GT(middle.y(), section.min.y());
  EXPECT_LT((middle - Vector2(0, 0)).norm(), 0.0075) << "on the cavity, not about the tool's last place";
}

// The page of a packing shows spheres that no tool has touched.
TEST(Section, ASectionOfAnUncutBoneHasNoBeforeAndAfter) {
  const SyntheticRun run =
      MakeSyntheticRun({.spacing_m = 1.5e-3, .cap_m = 1.4e-3, .point_spacing_m = 1.5e-3, .frames = 100});
  const std::string cut = SectionSvg(ComputeSection(run.bone, run.after, run.tool, PathOf(run)), run.bone);
  EXPECT_NE(cut.find(">before<"), std::string::npos);
  EXPECT_NE(cut.find(">swept by the tool<"), std::string::npos);
  const std::string whole = SectionSvg(ComputeSection(run.bone, {}, {}, {}), run.bone);
  EXPECT_EQ(whole.find(">before<"), std::string::npos);
  EXPECT_NE(whole.find(">outline of the spheres<"), std::string::npos);
}

TEST(Section, SvgIsWellFormed) {
  const SyntheticRun run =
      MakeSyntheticRun({.spacing_m = 1.5e-3, .cap_m = 1.4e-3, .point_spacing_m = 1.2e-3, .frames = 100});
  const Section section = ComputeSection(run.bone, run.after, run.tool, PathOf(run));
  const std::string svg = SectionSvg(section, run.bone);
  EXPECT_EQ(MarkupError(svg), "");
  EXPECT_EQ(TextOutside(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace osteon::report
