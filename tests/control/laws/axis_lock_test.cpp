#include "control/laws/axis_lock.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/control/loop/servo_bench.h"

// Tests locked axes: the correction that brings the tool back to its line or point, and the whole servo loop
// drilling along one axis.

namespace osteon::control {
namespace {

constexpr double kDt_s = 0.001;

// Locks all axes except this one, so that the tool can only move along a line.
AdmittanceParams FreeOnlyAlong(int axis) {
  AdmittanceParams params;
  params.locked.fill(true);
  params.locked[static_cast<std::size_t>(axis)] = false;
  return params;
}

// Each tick adds a small error to the same side, as an imprecise inverse kinematics does. Without the lock,
// the errors would add up to 2 mm.
TEST(AxisLock, SmallErrorsOverALongPathAreCorrectedToOneLine) {
  AdmittanceParams params = FreeOnlyAlong(2);
  params.centre_T_m = {0.0, 0.05, -0.2};
  AxisLock lock(params, kDt_s);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = ExpRotation({0.4, -0.3, 0.8});
  const Pose X_first = X_WT;
  lock.Reset(X_WT);
  const Vector3 drift_m(2e-8, -1e-8, 0.0), turn_rad(1e-8, 2e-8, -1e-8);
  for (int i = 0; i < 100'000; ++i) {
    const Twist held_C = lock.Correction(X_WT);
    Twist V;
    ASSERT_TRUE(NextTwist(params,
                          {.X_WT = X_WT,
                           .V_WT = {.v = 0.01 * X_WT.linear().col(2), .w = Vector3::Zero()},
                           .F_T_W = {.f = 0.2 * X_WT.linear().col(2), .t = Vector3::Zero()},
                           .dt_s = kDt_s,
                           .V_held_C = held_C},
                          V));
    X_WT = IntegratePose(X_WT, V, kDt_s);
    X_WT.translation() += drift_m;
    X_WT.linear() = ExpRotation(turn_rad) * X_WT.linear();
  }
  const Vector3 travel_T = X_first.linear().transpose() * (X_WT.translation() - X_first.translation());
  EXPECT_GT(travel_T.z(), 0.1) << "it has moved";
  EXPECT_LT(std::hypot(travel_T.x(), travel_T.y()), 1e-6) << "ten ticks' worth, of 2 mm";
  EXPECT_LT(LogRotation(X_first.linear().transpose() * X_WT.linear()).norm(), 1e-6);
}

TEST(AxisLock, TheCorrectionIsSlowAndZeroOnFreeAxes) {
  AxisLock lock(FreeOnlyAlong(2), kDt_s);
  lock.Reset(Pose::Identity());
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(0.01, 0.0, 0.3);
  X_WT.linear() = ExpRotation({0.0, 0.2, 0.0});
  const Twist held = lock.Correction(X_WT);
  EXPECT_LE(held.v.norm(), 0.020);
  EXPECT_GT(held.v.norm(), 0.019) << "less what the turned tool has along itself";
  EXPECT_EQ(held.v.z(), 0.0);
  EXPECT_NEAR(held.w.norm(), 0.1, 1e-12);
  EXPECT_LT(held.w.y(), 0.0);
  AxisLock none(AdmittanceParams{}, kDt_s);
  none.Reset(Pose::Identity());
  EXPECT_FALSE(none.any());
  EXPECT_EQ(none.Correction(X_WT).v, Vector3::Zero());
}

// The rotations are free and the centre's position is locked. The lock must correct only the position of the
// centre, because its reference turns with the tool.
TEST(AxisLock, AFreeRotationIsNotCorrected) {
  AdmittanceParams params;
  params.locked = {true, true, true, false, false, false};
  params.centre_T_m = {0.0, 0.0, -0.2};
  AxisLock lock(params, kDt_s);
  Pose X_WT = Pose::Identity();
  lock.Reset(X_WT);
  const Vector3 centre = X_WT * params.centre_T_m;
  Twist V;
  for (int i = 0; i < 3000; ++i) {
    ASSERT_TRUE(NextTwist(params,
                          {.X_WT = X_WT,
                           .V_WT = V,
                           .F_T_W = {.f = {30.0, 10.0, -40.0}, .t = {0.4, 0.3, 0.2}},
                           .dt_s = kDt_s,
                           .V_held_C = lock.Correction(X_WT)},
                          V));
    X_WT = IntegratePose(X_WT, V, kDt_s);
  }
  EXPECT_GT(LogRotation(X_WT.linear()).norm(), 0.5) << "it pivots about its centre";
  EXPECT_LT((X_WT * params.centre_T_m - centre).norm(), 10e-6);
}

// A hand pushes the tool 60 mm to the plane and back, and at the same time pulls it sideways with up to 40 N.
// The tool must stay within 10 µm of its line.
TEST(AxisLock, TheLoopStaysOnItsLineUnderSideForces) {
  ServoParams params = ServoBench::Params();
  params.admittance.locked = {true, true, false, true, true, true};
  ServoBench bench(params, 0.060);
  bench.Activate();
  const Pose X_first = ServoBench::StartPose();
  double max_aside_m = 0.0, max_turn_rad = 0.0, deepest_m = 0.0;
  for (int i = 0; i < 8000; ++i) {
    bench.push_N = i < 4000 ? 12.0 : -10.0;
    bench.side_W_N = Vector3(40.0 * std::sin(0.003 * i), 25.0, 10.0 * std::cos(0.01 * i));
    const TickRecord record = bench.Tick();
    ASSERT_EQ(record.faults, 0u) << i;
    const Pose X = record.X_WT_cmd;
    const Vector3 off_T = X_first.linear().transpose() * (X.translation() - X_first.translation());
    max_aside_m = std::max(max_aside_m, std::hypot(off_T.x(), off_T.y()));
    max_turn_rad = std::max(max_turn_rad, LogRotation(X_first.linear().transpose() * X.linear()).norm());
    deepest_m = std::max(deepest_m, off_T.z());
  }
  EXPECT_GT(deepest_m, 0.058) << "to the plane and back";
  EXPECT_LT(max_aside_m, 10e-6);
  EXPECT_LT(max_turn_rad, 1e-4);
}

// The workspace's bound crosses the tool's line at 45°. Without the lock, the tool would slide along the
// bound.
TEST(AxisLock, AtTheWorkspacesBoundTheToolStopsOnItsLine) {
  ServoParams params = ServoBench::Params();
  params.admittance.locked = {true, true, false, true, true, true};
  // the free axis meets the bound at 45 deg
  const Matrix3 R = ServoBench::StartPose().linear();
  params.workspace.plane_normal_W = (-R.col(2) + R.col(0)).normalized();
  params.workspace.plane_offset_m =
      Vector3(params.workspace.plane_normal_W).dot(ServoBench::StartPose().translation()) - 0.02;
  ServoBench bench(params, 0.2);
  bench.Activate();
  bench.push_N = 30.0;
  double max_aside_m = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const TickRecord record = bench.Tick();
    ASSERT_EQ(record.faults, 0u) << i;
    const Vector3 off_T =
        R.transpose() * (Pose(record.X_WT_cmd).translation() - ServoBench::StartPose().translation());
    max_aside_m = std::max(max_aside_m, std::hypot(off_T.x(), off_T.y()));
  }
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kWorkspace).ticks, 0u);
  EXPECT_LT(max_aside_m, 10e-6);
}

}  // namespace
}  // namespace osteon::control
