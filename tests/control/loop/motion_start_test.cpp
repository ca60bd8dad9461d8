#include "control/loop/motion_start.h"

#include <gtest/gtest.h>

#include "tests/control/loop/start_rig.h"

// Tests the start of a motion: its conditions, and the path from the arm's pose to the start pose.

namespace osteon::control {
namespace {

using safety::CellState, safety::Fault, safety::MotionPermit;

TEST(MotionStart, RenderingBeginsOnceEveryConditionHolds) {
  StartRig rig;
  rig.may_start = false;
  EXPECT_FALSE(rig.Tick());
  EXPECT_TRUE(rig.takes_commands);
  EXPECT_FALSE(rig.supervisor.permits().Has(MotionPermit::kPathChecked));
  EXPECT_TRUE(safety::Waits(rig.supervisor.state()));
  rig.may_start = true;
  bool begins = false;
  for (int i = 0; i < 3 && !begins; ++i) begins = rig.Tick();
  EXPECT_TRUE(begins);
  EXPECT_EQ(rig.supervisor.state(), CellState::kHaptic);
}

TEST(MotionStart, AnArmThatDoesNotTakeCommandsIsFollowed) {
  StartRig rig;
  rig.state.session = SessionState::kCommandingWait;
  rig.state.q_ipo[0] += 0.01;
  EXPECT_FALSE(rig.Tick());
  EXPECT_FALSE(rig.takes_commands);
  EXPECT_EQ(rig.tool.arm().q()[0], rig.state.q_ipo[0]);
}

TEST(MotionStart, AnArmOfAnotherPeriodIsAFault) {
  StartRig rig;
  rig.state.period_s = 4.0 * rig.params.period_s;
  EXPECT_FALSE(rig.Tick());
  EXPECT_TRUE(rig.supervisor.faults().Has(Fault::kPeriod));
  EXPECT_EQ(rig.supervisor.phase(), Phase::kStopped);
}

// The arm is handed over 0.02 rad away from the start pose, so it must first move there.
TEST(MotionStart, AtTheEndOfThePathRenderingBegins) {
  ServoParams params = ServoBench::Params();
  kinematics::JointVector q = ServoBench::StartJoints();
  q[0] += 0.02;
  params.arm_body = kinematics::ChainFrom(ServoBench::Arm().params());
  params.start = StartParams{.q = q, .path = {}};
  StartRig rig(params);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(rig.Tick());
  ASSERT_TRUE(rig.supervisor.on_path());
  EXPECT_EQ(rig.supervisor.state(), CellState::kAligning);
  bool begins = false;
  int ticks = 0;
  while (!begins && ++ticks < 10'000) {
    rig.state.q_meas = rig.tool.arm().q();
    begins =
        rig.Tick() || rig.start.StepPath(
                          {.state = rig.state, .readings = rig.readings, .model = rig.model, .now = rig.now});
  }
  EXPECT_TRUE(begins);
  EXPECT_FALSE(rig.supervisor.on_path());
  EXPECT_EQ(rig.supervisor.state(), CellState::kHaptic);
  EXPECT_NEAR(rig.tool.arm().q()[0], q[0], 1e-9);
}

}  // namespace
}  // namespace osteon::control
