#include <limits>

#include <gtest/gtest.h>

#include "tests/hil/fri/fri_server_bench.h"

// Tests the FRI server: its command modes, the control modes that they need, and the wrench or torque that
// each answer must contain.

namespace osteon::hil {
namespace {

using control::CommandMode;
using control::ControlMode;
using control::SessionState;

TEST(FriServer, CommandModesNeedTheirControlMode) {
  for (const auto control : {ControlMode::kPosition, ControlMode::kCartesianImpedance,
                             ControlMode::kJointImpedance, ControlMode::kNone})
    for (const auto command : {CommandMode::kPosition, CommandMode::kWrench, CommandMode::kTorque}) {
      Session s({.control_mode = control, .command_mode = command});
      s.client.wrench = std::vector<double>(6, 0.0);
      s.client.tau = std::vector<double>(7, 0.0);
      const bool agree = control != ControlMode::kNone &&
                         (command == CommandMode::kPosition ||
                          (command == CommandMode::kWrench && control == ControlMode::kCartesianImpedance) ||
                          (command == CommandMode::kTorque && control == ControlMode::kJointImpedance));
      EXPECT_EQ(s.WalkTo(SessionState::kCommandingActive), agree);
      EXPECT_EQ(s.server.stop().reason, agree ? StopReason::kNone : StopReason::kControlMode);
      EXPECT_EQ(UintAt(s.message, {2, 7}), static_cast<std::uint64_t>(control));
      if (agree) {
        EXPECT_EQ(UintAt(s.message, {5, 10}), static_cast<std::uint64_t>(command));
        EXPECT_FALSE(s.server.SetModes(ControlMode::kPosition, CommandMode::kPosition)) << "under way";
      } else {
        EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
        EXPECT_TRUE(s.server.SetModes(ControlMode::kPosition, CommandMode::kPosition));
        EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive)) << "once the program has put it right";
      }
    }
  Session s({.command_mode = CommandMode::kWrench});
  (void)s.WalkTo(SessionState::kCommandingActive);
  EXPECT_EQ(Describe(s.server.stop()),
            "control mode: POSITION control, the program's command mode needs CARTESIAN_IMPEDANCE control");
}

// In COMMANDING_WAIT the server only checks whether the wrench or torque is present. In COMMANDING_ACTIVE it
// also checks the values.
TEST(FriServer, EveryAnswerNeedsItsWrenchOrTorque) {
  for (const bool torque : {false, true}) {
    const FriServerParams params{
        .control_mode = torque ? ControlMode::kJointImpedance : ControlMode::kCartesianImpedance,
        .command_mode = torque ? CommandMode::kTorque : CommandMode::kWrench};
    Session without_overlay(params);
    ASSERT_TRUE(without_overlay.WalkTo(SessionState::kCommandingWait));
    for (int i = 0; i < 5; ++i) without_overlay.Cycle();  // the answers contain only the position
    EXPECT_EQ(without_overlay.server.counters().incomplete, 5u);
    EXPECT_EQ(without_overlay.server.stop().reason, StopReason::kLostInARow);

    Session s(params);
    (torque ? s.client.tau : s.client.wrench) = std::vector<double>(torque ? 7 : 6, 1e9);
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive)) << "ignored while waiting";
    EXPECT_EQ(s.server.F_commanded().f.norm() + s.server.tau_commanded().norm(), 0.0);
    (torque ? s.client.tau : s.client.wrench) = {1, 2, 3, 4, 5, 6};
    if (torque) s.client.tau.push_back(7);
    s.Cycle();
    if (torque) {
      EXPECT_EQ(s.server.tau_commanded()[6], 7.0);
      EXPECT_EQ(DoublesAt(s.message, {3, 4, 1}), s.client.tau) << "reported as commanded";
    } else {
      EXPECT_EQ(s.server.F_commanded().f, Vector3(1, 2, 3));
      EXPECT_EQ(s.server.F_commanded().t, Vector3(6, 5, 4)) << "A, B, C turn about z, y, x";
    }
    (torque ? s.client.tau : s.client.wrench)[1] = std::numeric_limits<double>::quiet_NaN();
    s.Cycle();
    EXPECT_EQ(s.server.stop().reason, StopReason::kNotFinite);
    EXPECT_EQ(s.server.stop().joint, torque ? 2 : 0);
    EXPECT_EQ(s.server.F_commanded().f.norm() + s.server.tau_commanded().norm(), 0.0) << "let go";

    Session one_value_short(params);
    (torque ? one_value_short.client.tau : one_value_short.client.wrench) =
        std::vector<double>(torque ? 7 : 6, 0.0);
    ASSERT_TRUE(one_value_short.WalkTo(SessionState::kCommandingActive));
    (torque ? one_value_short.client.tau : one_value_short.client.wrench).pop_back();
    one_value_short.Cycle();
    EXPECT_EQ(one_value_short.server.stop().reason, StopReason::kCount);
    EXPECT_EQ(one_value_short.server.stop().found, torque ? 6.0 : 5.0);
  }
}

TEST(FriServer, TheOrderOfAWrenchsTorquesCanBeChanged) {
  Session s({.control_mode = ControlMode::kCartesianImpedance,
             .command_mode = CommandMode::kWrench,
             .torques_zyx = false});
  s.client.wrench = {1, 2, 3, 4, 5, 6};
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.Cycle();
  EXPECT_EQ(s.server.F_commanded().t, Vector3(4, 5, 6));
}

}  // namespace
}  // namespace osteon::hil
