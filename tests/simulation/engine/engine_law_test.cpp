#include <algorithm>
#include <cmath>

#include "kinematics/half_spaces.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of the contact law on every engine: undercuts, the tool's own holes, friction, wedged tools, and
// motions that no hand can make.

namespace osteon::simulation {
namespace {

using EngineLaw = Engine;
OSTEON_ON_EVERY_ENGINE(EngineLaw);

constexpr double kStiffness = 20e3;  // stiffness of the coupling [N/m]
/// Overlap that the slide may leave, plus the depth to which a tool of 2 mm sinks into the lattice (0.5^2/8 /
/// (2 + 0.75) mm).
constexpr double kSurface_m = 0.02e-3 + 0.012e-3;

/// Parameters with the immediate law.
CuttingParams Immediate() {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  return params;
}

// A slot cut sideways, deeper than the head's centre: the bone above the head holds it down.
TEST_P(EngineLaw, AnUndercutHoldsTheHeadDown) {
  const double R = 2e-3, depth = 4e-3;
  const auto engine =
      Make(Slab(13e-3, 6e-3, false), MakeReamer(R, 0.8e-3, 8e-3, 0.9, Vector3::Zero()), Immediate());
  engine->Step(At(Down({-9e-3, 0, -depth}), kSpindle_rad_per_s));
  for (int i = 0; i <= 100; ++i) engine->Step(At(Down({-9e-3 + 0.1e-3 * i, 0, -depth}), kSpindle_rad_per_s));
  ContactModel model;
  for (int i = 1; i <= 80; ++i)
    model = engine->Step(At(Down({1e-3, 0, -depth + std::min(2e-3, 0.05e-3 * i)})));
  // the commanded tool is 2 mm above the roof, so the force is 40 N downwards; a roof of cut balls lets the
  // tool in by some hundredths of a millimetre
  EXPECT_NEAR(model.F_T_W.f.z, -40.0, 0.05 * 40.0);
  EXPECT_LT(model.n_W.z, -0.9);
  EXPECT_NEAR(Vector3(model.X_WP.p).z(), -depth, 0.1e-3);
}

// The drill is a row of balls. Moving along its hole it must not catch on the hole's balls one by one.
TEST_P(EngineLaw, ADrillMovesFreelyAlongItsOwnHole) {
  Tool drill;
  for (int i = 0; i < 6; ++i)
    drill.balls.push_back({.center_m = Vector3(0, 0, -2e-3 - 1e-3 * i), .radius_m = 2e-3, .cutting = i == 0});
  const auto engine = Make(Slab(7e-3, 6e-3, false), drill, Immediate());
  engine->Step(At(Down({0, 0, 0.1e-3}), kSpindle_rad_per_s));
  for (int i = 0; i <= 100; ++i) engine->Step(At(Down({0, 0, -0.04e-3 * i}), kSpindle_rad_per_s));
  double max_N = 0.0, lag_m = 0.0;
  for (int i = 0; i <= 200; ++i) {
    const double z = -4e-3 + 3e-3 * std::abs(std::sin(M_PI * i / 200.0));  // moves out by 3 mm and in again
    const ContactModel model = engine->Step(At(Down({0, 0, z})));
    max_N = std::max(max_N, std::abs(model.F_T_W.f.z));
    lag_m = std::max(lag_m, std::abs(Vector3(model.X_WP.p).z() - z));
  }
  EXPECT_LT(max_N, 0.5);
  EXPECT_LT(lag_m, 0.03e-3);
}

TEST_P(EngineLaw, FrictionFollowsTheToolWithinTheConeAndIsLimitedByIt) {
  Bone bone = Slab(12e-3, 2e-3, false);
  bone.materials[0].friction = 0.3;
  const auto engine = Make(bone, BallTool(5e-3));
  engine->Step(At(Down({0, 0, 0.1e-3})));
  for (int i = 0; i < 40; ++i) engine->Step(At(Down({0, 0, -2e-3})));
  // The normals on the lattice's balls lean by at most 0.25 / (5 + 0.75), upwards on one ball and downwards
  // on the next, and the friction cone leans with them.
  const double kSlopes = 2.0 * 0.25 / 5.75;
  // the friction force grows at the coupling's stiffness up to the edge of the cone, and falls on the way
  // back
  for (int i = 0; i <= 60; ++i) {
    const double x = 0.02e-3 * i;
    const ContactModel model = engine->Step(At(Down({x, 0, -2e-3})));
    const double normal_N = model.F_T_W.f.z;
    EXPECT_NEAR(normal_N, kStiffness * 2e-3, kStiffness * kSurface_m + 0.3) << i;
    const double expected = std::min(kStiffness * x, 0.3 * normal_N);
    EXPECT_NEAR(-model.F_T_W.f.x, expected, kSlopes * normal_N) << i;
    EXPECT_LT(std::abs(model.F_T_W.f.y), kSlopes * normal_N) << i;
  }
  const ContactModel back = engine->Step(At(Down({1.2e-3 - 0.3e-3, 0, -2e-3})));
  EXPECT_LT(-back.F_T_W.f.x, 0.3 * back.F_T_W.f.z - 0.8 * kStiffness * 0.3e-3);
}

// With a turning spindle the surface slips along its own speed, not along the feed. The bone is so hard that
// it is hardly cut.
TEST_P(EngineLaw, ATurningSpindleHasNoFrictionAlongTheFeed) {
  Bone bone = Slab(12e-3, 3e-3, true, 100.0 * kSpongy);
  bone.materials[0].friction = 0.3;
  const auto engine = Make(bone, BallTool(5e-3));
  engine->Step(At(Down({0, 0, 0.1e-3}), kSpindle_rad_per_s));
  for (int i = 0; i < 30; ++i) engine->Step(At(Down({0, 0, -2e-3}), kSpindle_rad_per_s));
  double tangential = 0.0;
  for (int i = 0; i <= 30; ++i) {
    const ContactModel model = engine->Step(At(Down({0.02e-3 * i, 0, -2e-3}), kSpindle_rad_per_s));
    tangential = std::max(tangential, Vector3(model.F_T_W.f).head<2>().norm());
  }
  EXPECT_LT(tangential, 0.1 * 40.0);
}

// The contract with the servo loop: at the frame's pose, the loop must compute the frame's wrench from the
// reported planes.
TEST_P(EngineLaw, ReportedContactsReproduceTheFramesWrench) {
  Bone bone = Slab(14e-3, 2e-3, false);
  AddBox({-7e-3, -7e-3, -2e-3}, {-5e-3, 7e-3, 8e-3}, bone, false);
  bone.materials[0].friction = 0.2;
  Tool tool;
  for (const double side : {-1.0, 1.0})
    tool.balls.push_back({.center_m = Vector3(1.5e-3 * side, 0, -2e-3), .radius_m = 2e-3, .cutting = true});
  const auto engine = Make(bone, tool);
  engine->Step(At(Down({1e-3, 0, 0.5e-3})));
  int compared = 0;
  for (int i = 1; i <= 120; ++i) {
    const double s = std::min(1.0, i / 100.0);
    const Pose X_WT = Down({1e-3 - 5e-3 * s, 1e-3 * s, 0.5e-3 - 3e-3 * s}, {0, 0.1 * s, 0.2 * s});
    const ContactModel model = engine->Step(At(X_WT));
    std::array<HalfSpace, kMaxHalfSpaces> planes{};
    for (int c = 0; c < model.contact_count; ++c) {
      const Contact& contact = model.contacts[static_cast<std::size_t>(c)];
      const Vector3 n = contact.n_W;
      const double gap = n.dot(X_WT * Vector3(contact.p_TP_m) - Vector3(contact.p_W_m));
      EXPECT_NEAR(gap, contact.gap_m, 1e-9);
      planes[static_cast<std::size_t>(c)] = {.n = n, .offset = -gap};
    }
    const HalfSpaceProjection servo = ClosestInHalfSpaces(planes, model.contact_count);
    Wrench F;
    for (int c = 0; c < model.contact_count; ++c) {
      const Contact& contact = model.contacts[static_cast<std::size_t>(c)];
      const Vector3 f = kStiffness * servo.multiplier[static_cast<std::size_t>(c)] * Vector3(contact.n_W);
      F.f += f;
      F.t += (X_WT.linear() * Vector3(contact.p_TP_m)).cross(f);
    }
    EXPECT_LT((F.f - Vector3(model.F_T_W.f)).norm(), 0.02) << i;
    EXPECT_LT((F.t - Vector3(model.F_T_W.t)).norm(), 0.5e-3) << i;
    compared += F.f.norm() > 10.0 ? 1 : 0;
  }
  EXPECT_GT(compared, 60);
}

TEST_P(EngineLaw, AWedgedToolsWrenchIsThatOfItsOverlap) {
  const double R = 2e-3;
  Bone bone = EmptyBone();
  AddBox({-R - 1.5e-3, -6e-3, 0}, {-R, 6e-3, 8e-3}, bone, false);
  AddBox({R, -6e-3, 0}, {R + 1.5e-3, 6e-3, 8e-3}, bone, false);
  Tool rod;
  for (int i = 0; i < 5; ++i)
    rod.balls.push_back({.center_m = Vector3(0, 0, -R - 1.5e-3 * i), .radius_m = R, .cutting = true});
  const auto engine = Make(bone, rod);
  engine->Step(At(Down({0, 0, 0})));
  ContactModel model;
  for (int i = 1; i <= 40; ++i) model = engine->Step(At(Down({0, 0, 0}, {0, 0.1 * i / 40.0, 0})));
  // At a rotation of 0.1 rad the rod's ends, 3 mm from its middle, are 0.3 mm too deep: about 6 N at a lever
  // of 3 mm for each end. Without a cap, the walls' multipliers would balance at thousands of newtons.
  EXPECT_LT(Vector3(model.F_T_W.t).norm(), 0.5);
  EXPECT_LT(Vector3(model.F_T_W.f).norm(), 30.0);
  EXPECT_LT(LogRotation(Pose(model.X_WP).linear() * Down(Vector3::Zero()).linear().transpose()).norm(), 0.05);
  // in this orientation the rod can be withdrawn along the slot
  for (int i = 1; i <= 300; ++i) model = engine->Step(At(Down({0, 0.06e-3 * i, 0}, {0, 0.1, 0})));
  EXPECT_NEAR(Vector3(model.X_WP.p).y(), 18e-3, 1e-6);
  EXPECT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
}

// Two balls press on the tool from exactly opposite sides. The resultant of their planes is zero, so it gives
// no direction for friction.
TEST_P(EngineLaw, AToolWedgedBetweenMirroredBallsStaysFinite) {
  Bone bone = EmptyBone();
  bone.materials[0].friction = 0.3;
  for (const double x : {-3e-3, 3e-3}) bone.balls.push_back({.center_m = Vector3(x, 0, 0), .radius_m = 1e-3});
  Tool tool;
  tool.balls = {{.center_m = Vector3::Zero(), .radius_m = 2.03e-3}};
  const auto engine = Make(bone, tool);
  Pose X_WT = Pose::Identity();
  for (int i = 0; i < 12; ++i) {
    X_WT.translation().y() = i < 2 ? 0.0 : i < 4 ? 1e-3 : i < 8 ? 0.0 : 1e-4 * (i - 8);
    const ContactModel model = engine->Step(At(X_WT));
    ASSERT_EQ(model.status, EngineStatus::kOk);
    ASSERT_TRUE(Pose(model.X_WP).matrix().allFinite()) << i;
    ASSERT_TRUE(Vector3(model.F_T_W.f).allFinite()) << i;
    ASSERT_LT((Vector3(model.X_WP.p) - X_WT.translation()).norm(), 1e-3 + 1e-9) << i;
    ASSERT_NEAR(Vector3(model.F_T_W.f).x(), 0.0, 1e-6) << i;
    for (int c = 0; c < model.contact_count; ++c)
      ASSERT_NEAR(Vector3(model.contacts[static_cast<std::size_t>(c)].n_W).norm(), 1.0, 1e-9) << i;
  }
}

// A cell may enlarge the tool by up to 5 mm when it computes the normal. The reported plane must still be
// that of the nearest ball.
TEST_P(EngineLaw, AnEnlargementBeyondAMillimetreStillReportsTheNearestBall) {
  Bone bone = EmptyBone();
  // the nearest ball comes last in the list, so that the order of balls cannot hide a missing comparison
  for (const double gap : {4.5e-3, 4.0e-3, 3.5e-3, 2.5e-3, 2.0e-3, 1.5e-3})
    bone.balls.push_back({.center_m = Vector3(0, 0, -1e-3 - gap), .radius_m = 1e-3});
  const auto engine = Make(bone, BallTool(3e-3), {.normal_enlargement_m = 5e-3});
  engine->Step(At(Down({0, 0, 1e-4})));
  const ContactModel model = engine->Step(At(Down({0, 0, 0})));
  ASSERT_EQ(model.contact_count, 1);
  EXPECT_NEAR(model.contacts[0].gap_m, 1.5e-3, 1e-7);
}

// The tool starts deep in bone, as after an undo has restored bone around the tool. The bone ball that the
// tool overlaps most must push the tool out.
TEST_P(EngineLaw, AToolPlacedDeepInBoneIsPushedOutByTheDeepestBall) {
  Bone bone = EmptyBone();
  for (const double depth : {1.2e-3, 1.6e-3, 2.0e-3, 3.0e-3})
    bone.balls.push_back({.center_m = Vector3(0, 0, -1e-3 + depth), .radius_m = 1e-3});
  CuttingParams params;
  params.max_slide_m = 5e-3;
  const ContactModel model = Make(bone, BallTool(4e-3), params)->Step(At(Down({0, 0, 0})));
  ASSERT_GT(model.contact_count, 0);
  EXPECT_NEAR(Vector3(model.X_WP.p).z(), 3.0e-3, 0.05e-3);
}

TEST_P(EngineLaw, AJumpOfAMetreStopsAtTheBone) {
  const auto engine = Make(Slab(12e-3, 2e-3, false), BallTool(5e-3));
  engine->Step(At(Down({0, 0, 0.5})));
  const ContactModel model = engine->Step(At(Down({0, 0, -0.5}), 0.0));
  EXPECT_EQ(model.status, EngineStatus::kOk);
  // tolerance: roundings of 6e-5 mm, since float32 covers a metre; the contact's root amplifies them
  EXPECT_NEAR(Vector3(model.X_WP.p).z(), 0.0, 0.05e-3);
  EXPECT_NEAR(Vector3(model.F_T_W.f).norm(), 200.0, 1e-9);
  const ContactModel free = engine->Step(At(Down({0.3, 0, 0.4})));
  EXPECT_EQ(Vector3(free.F_T_W.f).norm(), 0.0);
  EXPECT_LT((Vector3(free.X_WP.p) - Vector3(0.3, 0, 0.4)).norm(), 1e-6);
}

TEST_P(EngineLaw, AToolAtRestKeepsItsPoseAndForce) {
  Bone bone = Slab(12e-3, 2e-3, false);
  bone.materials[0].friction = 0.2;
  const auto engine = Make(bone, BallTool(5e-3));
  engine->Step(At(Down({0, 0, 0.1e-3})));
  ContactModel model;
  const Pose X_WT = Down({0.13e-3, 0.07e-3, -3e-3}, {0.02, 0.01, 0});
  for (int i = 0; i < 60; ++i) model = engine->Step(At(X_WT));
  const Vector3 p = model.X_WP.p, f = model.F_T_W.f;
  for (int i = 0; i < 50; ++i) {
    model = engine->Step(At(X_WT));
    ASSERT_LT((Vector3(model.X_WP.p) - p).norm(), 0.2e-6) << i;  // 0.2 um; scenario 6 allows 1
    ASSERT_LT((Vector3(model.F_T_W.f) - f).norm(), 0.02) << i;
  }
}

TEST_P(EngineLaw, ABoneWithoutBallsNeverTouches) {
  Bone bone = EmptyBone();
  if (GetParam() == EngineKind::kVulkan)  // the engine needs at least one ball: add a small one, far away
    bone.balls.push_back({.center_m = Vector3(1, 1, 1), .radius_m = 1e-4});
  const auto engine = Make(bone, BallTool(5e-3));
  for (int i = 0; i < 5; ++i) {
    const Pose X_WT = Down({1e-3 * i, 0, -2e-3 * i});
    const ContactModel model = engine->Step(At(X_WT, kSpindle_rad_per_s));
    EXPECT_EQ(model.status, EngineStatus::kOk);
    EXPECT_EQ(model.contact_count, 0);
    EXPECT_EQ(Vector3(model.F_T_W.f).norm(), 0.0);
    EXPECT_LT((Vector3(model.X_WP.p) - X_WT.translation()).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace osteon::simulation
