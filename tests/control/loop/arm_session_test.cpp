#include "control/loop/arm_session.h"

#include <gtest/gtest.h>

#include "tests/control/loop/servo_parts.h"

// Tests the session with the arm: its messages, whether the arm may be commanded, and whether the arm stands
// still.

namespace osteon::control {
namespace {

TEST(ArmSession, IsLostAfterThreeMissedMessagesInARow) {
  ServoParams params;
  params.watchdog.arm_misses = 3;
  ArmSession session(params);
  EXPECT_FALSE(session.OnMissedMessage());
  EXPECT_FALSE(session.OnMissedMessage());
  session.OnMessage(StandingArm(), Pose::Identity(), 1);
  EXPECT_FALSE(session.OnMissedMessage()) << "counted anew";
  EXPECT_FALSE(session.OnMissedMessage());
  EXPECT_TRUE(session.OnMissedMessage());
  EXPECT_TRUE(session.OnMissedMessage()) << "and from then on";
}

// Two messages with two lost messages between them are three periods apart. If this time counted as one
// period, the velocity would be three times too high.
TEST(ArmSession, MeasuresTheTwistOverTheTimeBetweenTwoMessages) {
  ServoParams params;
  params.impedance.twist_filter_s = 0.0;
  ArmSession session(params);
  ArmState state = StandingArm();
  Pose X_WT = Pose::Identity();
  session.OnMessage(state, X_WT, rt::kMillisecond);
  EXPECT_EQ(session.V_WT().v, Vector3::Zero()) << "the first has no velocity";
  X_WT.translation().x() = 3e-4;
  state.lost = 2;
  session.OnMessage(state, X_WT, 4 * rt::kMillisecond);
  EXPECT_DOUBLE_EQ(session.elapsed_s(), 3e-3);
  EXPECT_NEAR(session.V_WT().v.x(), 0.1, 1e-12);
  EXPECT_EQ(session.measured_at(), 4 * rt::kMillisecond);
}

TEST(ArmSession, AnotherActivationOfTheArmIsNotCommandedOn) {
  const ServoParams params;
  ArmSession session(params);
  ArmState state = StandingArm();
  state.activation = 1;
  EXPECT_TRUE(session.TakesCommands(state, true)) << "none is commanded yet";
  EXPECT_FALSE(session.IsSameActivation(state));
  session.StartCommanding(state);
  EXPECT_TRUE(session.IsSameActivation(state));
  EXPECT_EQ(session.activation(), 1u);
  state.activation = 2;
  EXPECT_FALSE(session.TakesCommands(state, true));
  EXPECT_TRUE(session.TakesCommands(state, false)) << "an arm that rests may be taken over anew";
  EXPECT_FALSE(session.IsSameActivation(state));
  state.activation = 1;
  state.session = SessionState::kMonitoringReady;
  EXPECT_FALSE(session.TakesCommands(state, false));
}

TEST(ArmSession, StandsAfterTenMessagesWithoutMotion) {
  const ServoParams params;
  ArmSession session(params);
  ArmState state = StandingArm();
  // a message in which one joint has moved by step_rad
  const auto receive = [&](double step_rad) {
    state.q_meas[3] += step_rad;
    session.OnMessage(state, Pose::Identity(), 1);
    session.UpdateStandstill(state.q_meas);
  };
  for (int i = 0; i < ArmSession::kStandingMessages - 1; ++i) receive(0.0);
  EXPECT_FALSE(session.stands());
  receive(1e-5);  // 0.01 rad/s, caused by one step of an encoder, must still count as standing
  EXPECT_TRUE(session.stands());
  receive(1e-4);
  EXPECT_FALSE(session.stands());
}

TEST(ArmSession, ChecksTheArmsPeriodAndTheCommandModeOfItsLaw) {
  ServoParams params;
  ArmState state = StandingArm();
  ArmSession position(params);
  EXPECT_TRUE(position.HasPeriod(state));
  state.period_s = 0.002;
  EXPECT_FALSE(position.HasPeriod(state));
  state.period_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(position.HasPeriod(state));
  EXPECT_TRUE(position.HasCommandMode(CommandMode::kPosition));
  EXPECT_FALSE(position.HasCommandMode(CommandMode::kTorque));
  params.law = Law::kImpedance;
  ArmSession overlay(params);
  EXPECT_FALSE(overlay.HasCommandMode(CommandMode::kPosition));
  EXPECT_TRUE(overlay.HasCommandMode(CommandMode::kWrench));
  EXPECT_TRUE(overlay.HasCommandMode(CommandMode::kTorque));
}

}  // namespace
}  // namespace osteon::control
