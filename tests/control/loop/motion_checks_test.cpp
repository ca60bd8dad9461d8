#include "control/loop/motion_checks.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/control/loop/rendering_rig.h"

// Tests the checks that each tick of a motion makes: tracking error, joints, requested pause, hand force.

namespace osteon::control {
namespace {

using safety::CellState, safety::Fault;

// Receives a message of the arm in which the tool's position deviates by error_m from its command.
void ReceiveWithError(RenderingRig& rig, double error_m) {
  Pose X_WT = rig.tool.X_WT();
  X_WT.translation().x() += error_m;
  rig.now += rt::kMillisecond;
  rig.session.OnMessage(rig.state, X_WT, rig.now);
}

TEST(MotionChecks, ATrackingErrorIsAFaultOnlyDuringMotion) {
  RenderingRig rig;
  const double error_m = 1.01 * rig.params.max_tracking_error_m;
  ReceiveWithError(rig, error_m);
  rig.motion_checks.CheckMotion(rig.state, false);
  EXPECT_FALSE(rig.supervisor.faults().Any());
  ASSERT_TRUE(rig.StartRendering());
  ReceiveWithError(rig, error_m);
  rig.motion_checks.CheckMotion(rig.state, false);
  EXPECT_TRUE(rig.supervisor.faults().Has(Fault::kTracking));
  EXPECT_NEAR(rig.statistics.peak_tracking_error_m, error_m, 1e-12);
}

TEST(MotionChecks, OverloadedJointsAreAFault) {
  RenderingRig rig;
  ASSERT_TRUE(rig.StartRendering());
  rig.motion_checks.CheckMotion(rig.state, false);
  EXPECT_FALSE(rig.supervisor.faults().Any());
  rig.motion_checks.CheckMotion(rig.state, true);
  EXPECT_TRUE(rig.supervisor.faults().Has(Fault::kJointLimit));
}

TEST(MotionChecks, ARequestedPauseBrakesTheMotion) {
  RenderingRig rig;
  ASSERT_TRUE(rig.StartRendering());
  rig.supervisor.RequestPause(true);
  rig.motion_checks.CheckMotion(rig.state, false);
  EXPECT_EQ(rig.supervisor.state(), CellState::kStop2);
}

TEST(MotionChecks, AHandWrenchThatIsNotFiniteIsAFaultAndIsDiscarded) {
  RenderingRig rig;
  ASSERT_TRUE(rig.StartRendering());
  rig.readings.force.F_S.f.x = std::numeric_limits<double>::quiet_NaN();
  rig.motion_checks.MeasureHand(rig.readings.force);
  EXPECT_TRUE(rig.supervisor.faults().Has(Fault::kNotFinite));
  EXPECT_EQ(rig.result.F_hand_T_W.f.norm(), 0.0);
}

}  // namespace
}  // namespace osteon::control
