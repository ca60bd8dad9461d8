#include <gtest/gtest.h>

#include "servo_bench.h"
#include "tests/kinematics/iiwa14.h"

// Tests the motion that moves the arm from the pose at its hand-over to the start pose, where rendering
// begins.

namespace osteon::control {
namespace {

using kinematics::JointVector;

// An arm that is handed over with A1 0.3 rad and A4 0.15 rad away from its start pose.
class ServoStart : public ::testing::Test {
 protected:
  static JointVector Goal() {
    JointVector q = ServoBench::StartJoints();
    q[0] += 0.3;
    q[3] -= 0.15;
    return q;
  }
  static ServoParams Params() {
    ServoParams params = ServoBench::Params();
    params.has_interlock = true;
    params.arm_body = kinematics::ChainFrom(ServoBench::Arm().params());
    params.start = StartParams{.q = Goal(), .path = {}};
    params.workspace.sphere_radius_m = 1.0;
    params.workspace.plane_offset_m = -1.0;
    return params;
  }
  TickRecord Tick() {
    bench.readings.interlock = {
        .stamp = bench.now + ServoBench::kTick, .permitted = permitted, .enabled = held};
    const JointVector before = Joints();
    const TickRecord record = bench.Tick();
    if (!before.isZero(0.0))  // there is no command before the first one
      max_step_rad = std::max(max_step_rad, (Joints() - before).cwiseAbs().maxCoeff());
    return record;
  }
  void Run(int count) {
    for (int i = 0; i < count; ++i) Tick();
  }
  JointVector Joints() const { return Eigen::Map<const JointVector>(bench.command.q.data()); }
  // Largest angle [rad] by which a joint still differs from the start pose.
  double RemainingAngle() const { return (Goal() - Joints()).cwiseAbs().maxCoeff(); }

  ServoBench bench{Params(), 10.0};  // no bone is near
  bool permitted{true}, held{true};  // whether the PLC permits motion; whether the enabling switch is held
  double max_step_rad{0.0};
};

TEST_F(ServoStart, TheArmMovesToTheStartAndRendersThere) {
  Run(5);
  bench.Activate();
  Run(2);
  EXPECT_EQ(bench.loop.phase(), Phase::kAligning);
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 0.0);
  max_step_rad = 0.0;
  int ticks = 0;
  while (bench.loop.phase() == Phase::kAligning && ++ticks < 20'000) Tick();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  EXPECT_LT(RemainingAngle(), 1e-9);
  EXPECT_GT(ticks, 500) << "slowly";
  EXPECT_LT(max_step_rad, 1e-3);
  EXPECT_EQ(bench.loop.statistics().active_ticks, 1u) << "the path to the start is no rendering";
  Run(100);
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  EXPECT_FALSE(bench.loop.faults().Any());
}

TEST_F(ServoStart, WithTheSwitchReleasedTheArmRestsAndContinuesLater) {
  Run(5);
  bench.Activate();
  Run(600);
  held = false;  // the PLC still permits motion, but the released switch alone must stop the arm
  Run(600);
  const double resting_rad = RemainingAngle();
  EXPECT_GT(resting_rad, 0.05);
  Run(500);
  EXPECT_EQ(RemainingAngle(), resting_rad);
  EXPECT_EQ(bench.loop.phase(), Phase::kAligning);
  EXPECT_FALSE(bench.loop.faults().Any());
  held = true;
  for (int i = 0; i < 20'000 && bench.loop.phase() == Phase::kAligning; ++i) Tick();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  EXPECT_LT(max_step_rad, 1e-3) << "no jump, not even when the switch is pressed again";
}

TEST_F(ServoStart, WithoutThePlcsPermissionTheArmRestsAndContinuesLater) {
  Run(5);
  bench.Activate();
  Run(600);
  permitted = false;
  Run(600);
  const double resting_rad = RemainingAngle();
  EXPECT_GT(resting_rad, 0.05);
  Run(500);
  EXPECT_EQ(RemainingAngle(), resting_rad);
  permitted = true;
  for (int i = 0; i < 20'000 && bench.loop.phase() == Phase::kAligning; ++i) Tick();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
}

TEST_F(ServoStart, AStopOnTheWayToTheStartStopsTheArm) {
  Run(5);
  bench.Activate();
  Run(600);
  bench.loop.RequestStop();
  Run(1000);
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
  EXPECT_GT(RemainingAngle(), 0.05);
  EXPECT_LT(max_step_rad, 1e-3);
  EXPECT_FALSE(bench.loop.faults().Any());
}

TEST_F(ServoStart, AnArmThatLeavesOnTheWayContinuesWhenItReturns) {
  Run(5);
  bench.Activate();
  Run(400);
  bench.arm.session = SessionState::kCommandingWait;
  Run(20);
  EXPECT_EQ(bench.loop.phase(), Phase::kWaiting);
  EXPECT_FALSE(bench.loop.faults().Any());
  bench.Activate();
  for (int i = 0; i < 20'000 && bench.loop.phase() != Phase::kHaptic; ++i) Tick();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  EXPECT_LT(RemainingAngle(), 1e-9);
}

TEST_F(ServoStart, TheMotionBeginsOnlyWhenItIsAllowed) {
  bench.loop.AllowStart(false);
  bench.Activate();
  Run(50);
  EXPECT_EQ(bench.loop.phase(), Phase::kWaiting);
  bench.loop.AllowStart(true);
  Run(2);
  EXPECT_EQ(bench.loop.phase(), Phase::kAligning);
}

TEST_F(ServoStart, AnArmAtTheStartRendersAtOnce) {
  ServoParams params = Params();
  params.start->q = ServoBench::StartJoints();
  ServoBench there(params);
  there.Activate();
  there.readings.interlock = {.stamp = there.now + ServoBench::kTick, .permitted = true, .enabled = true};
  there.Tick();
  EXPECT_EQ(there.loop.phase(), Phase::kHaptic);
}

}  // namespace
}  // namespace osteon::control
