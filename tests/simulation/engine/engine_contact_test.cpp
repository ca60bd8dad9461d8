#include <algorithm>
#include <random>

#include "simulation/bone/scenes.h"
#include "simulation/solids/cup_frame.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of contact without cutting, on every engine. The spindle stands still unless a test says otherwise.
// Limits with a row of failures.md are those of the table in docs/failures.md.

namespace osteon::simulation {
namespace {

using EngineContact = Engine;
OSTEON_ON_EVERY_ENGINE(EngineContact);

/// Overlap that the slide may leave, plus the depth to which a tool of 10 mm sinks between the lattice's
/// balls.
constexpr double kSurface_m = 0.02e-3 + 0.006e-3;
/// A few roundings of float32 coordinates of some centimetres, 2e-9 m each.
constexpr double kFloat_m = 2e-8;

Vector3 ApexOf(const ContactModel& model) { return Pose(model.X_WP).translation(); }

/// Steps the engine at one pose; @returns the last frame's model.
ContactModel Hold(CuttingEngine& engine, const Pose& X_WT, int frames) {
  ContactModel model;
  for (int i = 0; i < frames; ++i) model = engine.Step(At(X_WT));
  return model;
}

TEST_P(EngineContact, WithoutContactTheProxyFollowsTheToolWithoutForce) {
  const auto engine = Make(Slab(12e-3, 2e-3), MakeReamer(5e-3, 2e-3, 10e-3, 0.9, Vector3::Zero()));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    const Pose X_WT = Down({0.02 * u(random), 0.02 * u(random), 0.03 + 0.01 * u(random)},
                           0.3 * Vector3(u(random), u(random), u(random)));
    const ContactModel model = engine->Step(At(X_WT, kSpindle_rad_per_s));
    ASSERT_EQ(model.status, EngineStatus::kOk);
    ASSERT_EQ(model.contact_fraction, 1.0);
    ASSERT_EQ(model.contact_count, 0);
    ASSERT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
    ASSERT_EQ(Vector3(model.F_T_W.t).norm(), 0.0);
    ASSERT_EQ(Vector3(model.n_W).norm(), 0.0);
    ASSERT_EQ(model.removed_volume_m3, 0.0);
    ASSERT_EQ(model.frame, static_cast<std::uint64_t>(i + 1));
    ASSERT_LT((ApexOf(model) - X_WT.translation()).norm(), kFloat_m);
    ASSERT_LT(LogRotation(Pose(model.X_WP).linear().transpose() * X_WT.linear()).norm(), 1e-6);
  }
}

TEST_P(EngineContact, PressingIsResistedAlongTheSurfacesNormalByStiffnessTimesDepth) {
  const auto engine = Make(Slab(24e-3, 3e-3), BallTool(10e-3));
  engine->Step(At(Down({0, 0, 1e-3})));
  for (const double depth : {1e-3, 3e-3, 5e-3}) {
    const ContactModel model = Hold(*engine, Down({0.1e-3, 0.2e-3, -depth}), 40);
    EXPECT_NEAR(ApexOf(model).z(), 0.0, kSurface_m) << depth;
    EXPECT_LT(Degrees(model.n_W, Vector3::UnitZ()), 1.0) << depth;
    // to within 1 %, plus the uncertainty of the surface's place
    EXPECT_NEAR(Vector3(model.F_T_W.f).norm(), 20e3 * depth, 0.01 * 20e3 * depth + 20e3 * kSurface_m);
    EXPECT_LT(Degrees(model.F_T_W.f, Vector3::UnitZ()), 1.0) << depth;
    EXPECT_GE(model.contact_count, 1);
    EXPECT_NEAR(model.contacts[0].gap_m, -depth, kSurface_m + 0.01 * depth);
  }
}

// The paper's equation for first contact takes only positive roots: it drops every pair that overlaps
// already, and the tool would pass through the bone.
TEST_P(EngineContact, AToolThatOverlapsFromTheStartIsStoppedInwardsAndFreeOutwards) {
  Bone bone = EmptyBone();
  bone.balls.push_back({.center_m = Vector3(0, 0, -1e-3), .radius_m = 1e-3});
  const auto engine = Make(bone, BallTool(5e-3));
  engine->Step(At(Down({0, 0, -0.3e-3})));  // the first pose counts as free
  for (int i = 1; i <= 40; ++i) {
    const ContactModel model = engine->Step(At(Down({0, 0, -0.3e-3 - 0.1e-3 * i})));
    ASSERT_EQ(model.contact_fraction, 0.0) << i;
    ASSERT_GE(ApexOf(model).z(), -0.3e-3 - kFloat_m) << i;
    ASSERT_GT(Vector3(model.F_T_W.f).z(), 0.0) << i;
  }
  const ContactModel out = engine->Step(At(Down({0.1e-3, 0, 2e-3})));
  EXPECT_EQ(out.contact_fraction, 1.0);
  EXPECT_NEAR(ApexOf(out).z(), 2e-3, kFloat_m);
}

// Pressed 30 mm deep at 20 N/mm the force would be 600 N; the limit is 200 N.
TEST_P(EngineContact, ForceIsLimited) {
  const auto engine = Make(Slab(24e-3, 3e-3), BallTool(10e-3));
  engine->Step(At(Down({0, 0, 1e-3})));
  const ContactModel model = Hold(*engine, Down({0, 0, -30e-3}), 10);
  EXPECT_NEAR(Vector3(model.F_T_W.f).norm(), 200.0, 1e-9);
  EXPECT_LT(Degrees(model.F_T_W.f, Vector3::UnitZ()), 1.0);
}

TEST_P(EngineContact, FastApproachStopsAtTheSurfaceInTheFirstFrame) {
  const auto engine = Make(Slab(24e-3, 3e-3), BallTool(10e-3));
  engine->Step(At(Down({0, 0, 3e-3})));
  const ContactModel model = engine->Step(At(Down({0, 0, -4e-3})));  // 7 m/s
  EXPECT_NEAR(model.contact_fraction, 3.0 / 7.0, kSurface_m / 7e-3);
  EXPECT_NEAR(ApexOf(model).z(), 0.0, kSurface_m);
  EXPECT_NEAR(Vector3(model.F_T_W.f).z(), 80.0, 0.01 * 80.0 + 20e3 * kSurface_m);
}

TEST_P(EngineContact, SlidingOverFlatBoneKeepsASteadyForceAndDoesNotStick) {
  const auto engine = Make(Slab(24e-3, 3e-3, false), BallTool(10e-3));
  engine->Step(At(Down({-6e-3, 0, 0.5e-3})));
  Hold(*engine, Down({-6e-3, 0, -2e-3}), 40);
  double low = 1e9, high = 0.0, tangential = 0.0, lag = 0.0;
  for (int i = 0; i <= 400; ++i) {
    const double x = -6e-3 + 0.03e-3 * i;  // 30 mm/s, 12 mm
    const ContactModel model = engine->Step(At(Down({x, 0.13 * x, -2e-3})));
    const Vector3 f = model.F_T_W.f;
    low = std::min(low, f.z());
    high = std::max(high, f.z());
    tangential = std::max(tangential, f.head<2>().norm());
    lag = std::max(lag, std::abs(ApexOf(model).x() - x));
  }
  EXPECT_GT(low, 40.0 - 1.0);
  EXPECT_LT(high, 40.0 + 1.0);
  EXPECT_LT(tangential, 0.07 * 40.0);  // failures.md row 7
  EXPECT_LT(lag, 0.15e-3);             // the tangential limit over the stiffness of 20 N/mm is 0.14 mm
}

// From contact, the tool moves 4 mm away in a random direction above the surface and rotates.
TEST_P(EngineContact, LeavingIsNeverBlocked) {
  const auto engine = Make(Slab(24e-3, 3e-3, false), BallTool(10e-3));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int shot = 0; shot < 30; ++shot) {
    const Vector3 from(4e-3 * u(random), 4e-3 * u(random), 0.0);
    engine->Step(At(Down(from + Vector3(0, 0, 8e-3))));
    Hold(*engine, Down(from - Vector3(0, 0, 3e-3)), 15);
    const double azimuth = 2.0 * M_PI * u(random), elevation = (0.1 + 0.4 * u(random)) * M_PI;
    const Vector3 way = 4e-3 * Vector3(std::cos(elevation) * std::cos(azimuth),
                                       std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    // from the surface, and from inside: the proxy is at the surface in both cases
    const Pose X_WT = Down(from + way, 0.2 * Vector3(u(random), u(random), u(random)));
    const ContactModel model = engine->Step(At(X_WT));
    ASSERT_EQ(model.contact_fraction, 1.0) << shot;
    ASSERT_EQ(Vector3(model.F_T_W.f).norm(), 0.0) << shot;
    ASSERT_LT((ApexOf(model) - X_WT.translation()).norm(), kFloat_m) << shot;
  }
}

// A small version of failures.md row 1: 200 shots at a sheet 1 mm thick.
TEST_P(EngineContact, NoToolPassesThroughAThinSheet) {
  Bone bone = EmptyBone();
  const double half = 16e-3;
  // one layer of balls 1.5 mm thick, reduced to 1 mm by a radius of 0.5 mm on a 0.5 mm lattice
  AddBox({-half, -half, -0.75e-3}, {half, half, 0.75e-3}, bone, false);
  for (Ball& ball : bone.balls) ball.radius_m = 0.5e-3;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  int crossings = 0, touches = 0;
  for (const double R : {2e-3, 3e-3, 5e-3, 5e-3}) {
    const auto engine = Make(bone, BallTool(R));
    const CarvedState fresh = engine->Snapshot();
    for (int shot = 0; shot < 50; ++shot) {
      engine->Restore(fresh);
      const double speed_m_per_s = std::pow(10.0, -1.0 + u(random)), dt_s = 2e-3;
      const double azimuth = 2.0 * M_PI * u(random), slope = 0.7 * u(random);
      const Vector3 way(slope * std::cos(azimuth), slope * std::sin(azimuth), -1.0);
      const Vector3 start(6e-3 * (u(random) - 0.5), 6e-3 * (u(random) - 0.5), 1e-3);
      const double length_m = 2.0 * R + 4e-3;
      ContactModel model;
      for (double s = 0.0; s < length_m; s += speed_m_per_s * dt_s) {
        model = engine->Step(At(Down(start + s * way), 0.0, dt_s));
        // the ball's centre must stay above the sheet: R above its middle, less the tolerance
        const double centre_z = ApexOf(model).z() + R;
        if (centre_z < 0.5 * R) {
          ++crossings;
          break;
        }
      }
      touches += model.contact_count > 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(crossings, 0);
  EXPECT_EQ(touches, 200);
}

TEST_P(EngineContact, TheForceInACornerIsTheVectorSumOfBothFaces) {
  Bone bone = Slab(24e-3, 2e-3, false);
  AddBox({-8e-3, -12e-3, -2e-3}, {-6e-3, 12e-3, 14e-3}, bone, false);  // a wall; its face is x = -6 mm
  const auto engine = Make(bone, BallTool(10e-3));
  engine->Step(At(Down({6e-3, 0, 2e-3})));
  ContactModel model;
  const Vector3 goal(4e-3 - 3e-3, 0, -4e-3);  // 3 mm into the wall, 4 mm into the floor
  for (int i = 1; i <= 100; ++i)
    model = engine->Step(
        At(Down(Vector3(6e-3, 0, 2e-3) + std::min(1.0, i / 50.0) * (goal - Vector3(6e-3, 0, 2e-3)))));
  const Vector3 expected(60.0, 0.0, 80.0);
  // 7 % (failures.md row 4)
  EXPECT_LT((Vector3(model.F_T_W.f) - expected).norm(), 0.07 * expected.norm())
      << Vector3(model.F_T_W.f).transpose();
  // the pressed tool must not oscillate (no limit cycle)
  const Vector3 rest = ApexOf(model);
  for (int i = 0; i < 50; ++i) {
    model = engine->Step(At(Down(goal)));
    ASSERT_LT((ApexOf(model) - rest).norm(), 1e-6) << i;
  }
}

TEST_P(EngineContact, TheToolMovesFreelyAlongASlotOfItsOwnWidth) {
  Bone bone = EmptyBone();
  const double R = 4e-3;
  AddBox({-R - 1.5e-3, -10e-3, 0}, {-R, 10e-3, 6e-3}, bone, false);
  AddBox({R, -10e-3, 0}, {R + 1.5e-3, 10e-3, 6e-3}, bone, false);
  const auto engine = Make(bone, BallTool(R));
  engine->Step(At(Down({0, -5e-3, -1e-3})));
  ContactModel model;
  for (int i = 0; i <= 200; ++i) {
    const double y = -5e-3 + 0.05e-3 * i;
    model = engine->Step(At(Down({1e-3, y, -1e-3})));  // pressed 1 mm into one wall
    ASSERT_LT(std::abs(ApexOf(model).x()), 0.05e-3) << i;
  }
  EXPECT_NEAR(ApexOf(model).y(), 5e-3, 0.1e-3);
  EXPECT_NEAR(Vector3(model.F_T_W.f).x(), -20.0, 1.0);
}

TEST_P(EngineContact, ShaftTouchesAndDoesNotCut) {
  const auto bone = Slab(24e-3, 3e-3);
  Tool tool;  // the small cutting head stays above the bone; the larger shaft ball touches it
  tool.balls = {{.center_m = Vector3(0, 0, -12e-3), .radius_m = 2e-3, .cutting = true},
                {.center_m = Vector3(0, 0, -6e-3), .radius_m = 6e-3, .cutting = false}};
  const auto engine = Make(bone, tool);
  const std::uint64_t before = HashState(engine->Snapshot());
  engine->Step(At(Down({0, 0, 1e-3}), kSpindle_rad_per_s));
  ContactModel model;
  for (int i = 0; i < 40; ++i) model = engine->Step(At(Down({0, 0, -2e-3}), kSpindle_rad_per_s));
  EXPECT_NEAR(Vector3(model.F_T_W.f).z(), 40.0, 0.01 * 40.0 + 20e3 * kSurface_m);
  EXPECT_EQ(model.removed_volume_m3, 0.0);
  EXPECT_EQ(model.advance_m_per_s, 0.0);
  EXPECT_EQ(model.spindle_torque_Nm, 0.0);
  EXPECT_EQ(HashState(engine->Snapshot()), before);
}

// Light and slippery tissue at x < 0, dense and rough tissue at x > 0.
Bone TwoTissues(double width_m) {
  Bone bone = Slab(width_m, 3e-3);
  bone.materials.push_back(bone.materials.front());
  bone.materials[0].friction = 0.1;
  bone.materials[1].name = "dense";
  bone.materials[1].density_kg_per_m3 = 2000.0;
  bone.materials[1].friction = 0.4;
  for (MassPoint& point : bone.points) point.material = point.p_m.x > 0.0 ? 1 : 0;
  return bone;
}

TEST_P(EngineContact, AShaftsContactHasTheMaterialAndFrictionOfItsPlace) {
  Tool tool;
  tool.balls = {{.center_m = Vector3(0, 0, -12e-3), .radius_m = 2e-3, .cutting = true},
                {.center_m = Vector3(0, 0, -6e-3), .radius_m = 6e-3, .cutting = false}};
  for (const double x : {-6e-3, 6e-3}) {
    const auto engine = Make(TwoTissues(24e-3), tool);
    engine->Step(At(Down({x, 0, 1e-3})));
    ContactModel model;
    for (int i = 0; i < 40; ++i) model = engine->Step(At(Down({x, 0, -1e-3})));
    ASSERT_GT(model.contact_count, 0);
    EXPECT_EQ(model.contacts[0].material, x > 0.0 ? 1 : 0);
    EXPECT_EQ(model.contacts[0].mu, x > 0.0 ? 0.4 : 0.1);
    // the tool is dragged along y; the friction must be that of the tissue below the tool
    for (int i = 0; i < 60; ++i) model = engine->Step(At(Down({x, 0.05e-3 * i, -1e-3})));
    const Vector3 f = model.F_T_W.f;
    EXPECT_NEAR(-f.y() / f.z(), x > 0.0 ? 0.4 : 0.1, 0.03);
    EXPECT_EQ(engine->Snapshot().contact.friction, x > 0.0 ? 0.4 : 0.1);
  }
}

// The paper weights each lens by its ball's density, which would tilt a flat wall's normal at a border
// between tissues. The engine must not do so.
TEST_P(EngineContact, DenserTissueDoesNotTurnTheNormal) {
  const auto engine = Make(TwoTissues(20e-3), BallTool(6e-3));
  engine->Step(At(Down({0, 0, 1e-3})));
  ContactModel model;
  for (int i = 0; i < 20; ++i) model = engine->Step(At(Down({0, 0, -1e-3})));
  EXPECT_GT(Vector3(model.F_T_W.f).z(), 15.0);
  EXPECT_LT(Degrees(model.n_W, Vector3::UnitZ()), 0.5);
}

TEST_P(EngineContact, AStillSpindleRemovesNothing) {
  for (const RemovalLaw law : {RemovalLaw::kRate, RemovalLaw::kImmediate}) {
    CuttingParams params;
    params.law = law;
    const auto engine = Make(Slab(16e-3, 3e-3), BallTool(6e-3), params);
    const std::uint64_t before = HashState(engine->Snapshot());
    engine->Step(At(Down({0, 0, 1e-3})));
    ContactModel model;
    for (int i = 0; i < 60; ++i) model = engine->Step(At(Down({0.02e-3 * i, 0, -4e-3})));
    EXPECT_GT(Vector3(model.F_T_W.f).z(), 70.0);
    EXPECT_EQ(model.removed_volume_m3, 0.0);
    EXPECT_EQ(model.cutting_work_J, 0.0);
    EXPECT_EQ(HashState(engine->Snapshot()), before);
  }
}

// failures.md row 3: a reamer of 24 mm in a cup of 25 mm.
TEST_P(EngineContact, InACupThePressedToolIsHeldAlongTheCupsNormal) {
  AcetabulumParams scene;
  scene.shape.cup_radius_m = 25e-3;
  const Bone bone = MakeAcetabulum(scene);
  const double R = 24e-3;
  const auto engine = Make(bone, BallTool(R));
  // the tool's centre moves on a sphere of 3 mm around the cup's centre: 1 mm of clearance, 2 mm of depth
  engine->Step(At(Down({0, 0, -R})));
  Vector3 before = Vector3::Zero();
  double sum_deg = 0.0;
  int frames = 0;
  for (int i = 0; i <= 90; ++i) {
    const double angle = 45.0 * i / 90.0 * M_PI / 180.0;
    const Vector3 out(std::sin(angle), 0, -std::cos(angle));
    const Pose X_WT = Down(3e-3 * out - Vector3(0, 0, R));
    const ContactModel model = engine->Step(At(X_WT));
    if (i < 4) continue;  // the first frames reach the wall
    // The force points back to the cup's centre. The packing's wall has a roughness of 0.03 mm (95th
    // percentile), at a clearance of 1 mm.
    EXPECT_LT(Degrees(model.n_W, -out), 8.0) << i;
    if (before != Vector3::Zero()) {
      EXPECT_GT(before.dot(Vector3(model.n_W)), 0.9) << i;
    }
    before = model.n_W;
    sum_deg += Degrees(model.n_W, -out);
    ++frames;
  }
  std::printf("normal off by %.2f deg in the mean\n", sum_deg / frames);
  EXPECT_LT(sum_deg / frames, 3.5);
}

}  // namespace
}  // namespace osteon::simulation
