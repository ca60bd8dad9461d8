#include <limits>

#include <gtest/gtest.h>

#include "tests/hil/fri/fri_server_bench.h"

// Tests the FRI server: commands that stop the arm, emergency stops, and the acknowledgement of a stop.

namespace osteon::hil {
namespace {

using control::ControlMode;
using control::SessionState;
using kinematics::JointVector;

// Sends one illegal command. Expects that the arm stops for this reason, that the stop names the joint and
// its description contains `text`, and that the arm stays where it was.
void ExpectStop(const std::vector<double>& q, StopReason reason, int joint, const std::string& text,
                SessionState from = SessionState::kCommandingActive) {
  Session s;
  ASSERT_TRUE(s.WalkTo(from));
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, reason);
  EXPECT_EQ(s.server.stop().joint, joint);
  EXPECT_NE(Describe(s.server.stop()).find(text), std::string::npos) << Describe(s.server.stop());
  EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
  EXPECT_EQ(UintAt(s.message, {2, 2}), 2u);  // safety stop: STOP_LEVEL_1
  EXPECT_EQ(UintAt(s.message, {2, 5}), 0u);  // drive state: off
  // the stop lasts even if the client then answers perfectly
  for (int i = 0; i < 1000; ++i) s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
  EXPECT_EQ(UintAt(s.message, {2, 2}), 2u);
}

TEST(FriServer, StopsOnAnIllegalCommand) {
  auto q = Start();
  q[3] += 75.0 * 3.14159265358979 / 180.0 * 1e-3 * 1.1 +
          1e-6;  // A4 may move at 75 deg/s for 1 ms with a margin of 1.1; this step is just too far
  ExpectStop(q, StopReason::kJointStep, 4, "joint step: A4");
  q = Start();
  q[1] = 2.1;  // beyond the limit of A2: 120 deg = 2.0944 rad
  ExpectStop(q, StopReason::kJointLimit, 2, "joint limit: A2 commanded 2.1000 rad, accepted at most 2.0944");
  q = Start();
  q[1] = -2.1;
  ExpectStop(q, StopReason::kJointLimit, 2,
             "joint limit: A2 commanded -2.1000 rad, accepted at least -2.0944");
  q = Start();
  q[6] = std::numeric_limits<double>::quiet_NaN();
  ExpectStop(q, StopReason::kNotFinite, 7, "not finite: A7");
  q[6] = -std::numeric_limits<double>::infinity();
  ExpectStop(q, StopReason::kNotFinite, 7, "not finite: A7");
  ExpectStop(std::vector<double>(6, 0.5), StopReason::kCount, 0, "6 values");
  ExpectStop(std::vector<double>(8, 0.5), StopReason::kCount, 0, "8 values");
  q = Start();
  q[0] = 0.5011;
  ExpectStop(q, StopReason::kNotMirrored, 1, "not mirrored: A1", SessionState::kCommandingWait);
  q[0] = std::numeric_limits<double>::quiet_NaN();
  ExpectStop(q, StopReason::kNotMirrored, 1, "not mirrored: A1", SessionState::kCommandingWait);
}

// After the acknowledgement, the drives need half a second to switch on. Then the robot's program requests
// commanding again.
TEST(FriServer, AStoppedArmIgnoresCommandsUntilTheAcknowledgement) {
  for (const int level : {0, 1, 2}) {
    Session s;
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    s.server.EmergencyStop(level);
    s.Cycle();
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
    EXPECT_EQ(s.server.stop().reason, StopReason::kEmergencyStop);
    EXPECT_EQ(UintAt(s.message, {2, 2}), static_cast<std::uint64_t>(level) + 1);
    EXPECT_EQ(UintAt(s.message, {2, 5}), 0u);
    for (int i = 0; i < 1000; ++i)
      s.Command(std::vector<double>(7, 0.6));  // a client that has not noticed the stop
    EXPECT_EQ(s.server.counters().ignored, 1000u);
    EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);

    s.server.Acknowledge();
    s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 2}), 0u);
    EXPECT_EQ(UintAt(s.message, {2, 5}), 1u);  // drive state: transitioning
    for (int i = 0; i < 498; ++i) s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 5}), 1u);
    s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 5}), 2u);
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
    EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    EXPECT_EQ(s.server.counters().ignored, 1000u) << "mirrored answers are no commands";
  }
}

// "Illegal axis delta": in impedance control a hand may push the arm away from its command. Beyond 0.1 rad
// this stops the arm. Position control has no such limit.
TEST(FriServer, ACommandFarFromTheMeasuredPositionStopsACompliantArm) {
  for (const auto control :
       {ControlMode::kPosition, ControlMode::kCartesianImpedance, ControlMode::kJointImpedance})
    for (const double off_rad : {0.099, 0.101}) {
      Session s({.control_mode = control});
      ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
      JointVector q = s.server.q_commanded();
      q[3] += off_rad;
      const auto bytes = s.server.BeginCycle({.q = q}, ++s.cycles * rt::kMillisecond);
      s.message.assign(bytes.begin(), bytes.end());
      s.Cycle();
      const bool illegal = control != ControlMode::kPosition && off_rad > 0.1;
      EXPECT_EQ(s.server.stop().reason, illegal ? StopReason::kAxisDelta : StopReason::kNone);
      if (!illegal) continue;
      EXPECT_EQ(s.server.stop().joint, 4);
      EXPECT_EQ(Describe(s.server.stop()),
                "illegal axis delta: A4 commanded 0.1010 rad from where it is, accepted 0.1000");
      EXPECT_EQ(UintAt(s.message, {2, 2}), 2u);
    }
}

TEST(FriServer, FollowsAStepJustWithinTheVelocityLimit) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  auto q = Start();
  const double step = 75.0 * 3.14159265358979 / 180.0 * 1e-3 * 1.1 - 1e-9;
  q[3] += step;
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
  // after two lost answers, the next command may be three steps away
  s.Cycle(false);
  s.Cycle(false);
  q[3] += 3.0 * step;
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
  EXPECT_EQ(s.server.q_commanded()[3], q[3]);
}

}  // namespace
}  // namespace osteon::hil
