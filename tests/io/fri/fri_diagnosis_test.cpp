#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/io/fri/fri_session_fixture.h"

// Tests FriSession::Diagnosis(), the text that tells an operator why the arm is not commanded.

namespace osteon::io {
namespace {

using control::ArmState;
using test::Bytes;
using test::Datagram;
using test::Monitoring;

constexpr std::array kFamilies{FriVersion::k1_15, FriVersion::k2_5,
                               FriVersion::k2_7};  // one version of each family

TEST_F(FriSessionTest, SaysWhichVersionTheArmSpeaks) {
  for (const FriVersion arm : kFamilies)
    for (const FriVersion client : kFamilies) {
      FriSession session({.version = client});
      ArmState state;
      EXPECT_NE(session.Diagnosis().find("No message"), std::string::npos);
      for (std::uint32_t i = 0; i < 3; ++i)
        session.Accept(Datagram(FamilyOf(arm), Monitoring(i, fri::MONITORING_READY, FamilyOf(arm))), 1,
                       state);
      EXPECT_EQ(state.other_version, arm == client ? 0u : 3u);
      EXPECT_EQ(state.rejected, state.other_version);
      if (arm == client) continue;
      EXPECT_EQ(session.last_error(), CodecError::kOtherVersion);
      EXPECT_EQ(session.other_family(), FamilyOf(arm));
      EXPECT_EQ(session.Diagnosis(), "The arm speaks " + std::string(Describe(FamilyOf(arm))) +
                                         ", configured is " + Name(client) +
                                         " (3 messages refused): set the version to the arm's.");
    }
}

TEST_F(FriSessionTest, NamesTheConditionThatKeepsTheArmFromMoving) {
  std::uint32_t sequence = 0;
  const auto with = [&](fri::SessionState state, auto change) {
    fri::FRIMonitoringMessage m = Monitoring(++sequence, state);
    change(m);
    EXPECT_EQ(session_.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
    return session_.Diagnosis();
  };
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const std::vector<std::uint8_t> noise{1, 2, 3};
  session_.Accept(noise, 1, state_);
  EXPECT_TRUE(contains(session_.Diagnosis(), "none was a message of FRI 1.15"));
  EXPECT_TRUE(contains(
      with(fri::MONITORING_WAIT, [](auto& m) { m.mutable_connectioninfo()->set_quality(fri::FAIR); }),
      "FAIR, commanding needs GOOD"));
  EXPECT_TRUE(contains(with(fri::MONITORING_READY, [](auto&) {}), "has not asked for commanding"));
  EXPECT_EQ(with(fri::COMMANDING_WAIT, [](auto&) {}), "");
  EXPECT_TRUE(contains(
      with(fri::COMMANDING_WAIT, [](auto& m) { m.mutable_ipodata()->set_clientcommandmode(fri::WRENCH); }),
      "needs Cartesian impedance control; the arm is in position control"));
  EXPECT_TRUE(contains(
      with(fri::COMMANDING_WAIT, [](auto& m) { m.mutable_ipodata()->set_clientcommandmode(fri::TORQUE); }),
      "needs joint impedance control"));
  EXPECT_TRUE(contains(
      with(fri::MONITORING_READY, [](auto& m) { m.mutable_robotinfo()->set_safetystate(fri::STOP_LEVEL_1); }),
      "safety stop (level 1)"));
  EXPECT_TRUE(contains(with(fri::MONITORING_READY,
                            [](auto& m) { m.mutable_robotinfo()->set_drivestate(2, fri::TRANSITIONING); }),
                       "Not all drives"));
}

// The states of a public log: MONITORING_WAIT, MONITORING_READY, and 83 ms later IDLE. Once the arm has ended
// its session, the quality that it reports says nothing about the network.
TEST_F(FriSessionTest, ASessionThatTheArmEndedIsNotReportedAsPoorConnection) {
  ASSERT_EQ(AcceptMessage(1, fri::MONITORING_WAIT), FriAccept::kAccepted);
  ASSERT_EQ(AcceptMessage(2, fri::MONITORING_READY), FriAccept::kAccepted);
  fri::FRIMonitoringMessage idle = Monitoring(3, fri::IDLE);
  idle.mutable_connectioninfo()->set_quality(fri::POOR);
  ASSERT_EQ(session_.Accept(Bytes(idle), ++now_, state_), FriAccept::kAccepted);
  EXPECT_EQ(session_.Diagnosis(),
            "The arm's session is IDLE, it was MONITORING_READY: its program has ended it, or was cancelled; "
            "start the program again.");
  idle.mutable_header()->set_sequencecounter(4);
  ASSERT_EQ(session_.Accept(Bytes(idle), ++now_, state_), FriAccept::kAccepted);
  EXPECT_NE(session_.Diagnosis().find("it was MONITORING_READY"), std::string::npos) << "still";
}

TEST_F(FriSessionTest, ReportsThatTheArmLeftCommanding) {
  ASSERT_EQ(AcceptMessage(1, fri::COMMANDING_ACTIVE), FriAccept::kAccepted);
  ASSERT_EQ(AcceptMessage(2, fri::MONITORING_READY), FriAccept::kAccepted);
  EXPECT_EQ(session_.Diagnosis(),
            "The arm has left COMMANDING_ACTIVE for MONITORING_READY. The robot program has not asked for "
            "commanding.");
}

// One measured joint in a message is not a number. The message must not count as silence: the loop gets its
// joints and its time, so that it can stop, but nothing else from it.
TEST_F(FriSessionTest, AJointThatIsNotANumberReachesTheLoopAndIsNotAnswered) {
  ASSERT_EQ(AcceptMessage(1, fri::COMMANDING_ACTIVE), FriAccept::kAccepted);
  (void)Answer(state_.q_ipo);
  fri::FRIMonitoringMessage bad = Monitoring(2, fri::MONITORING_READY);
  bad.mutable_monitordata()->mutable_measuredjointposition()->set_value(2, std::nan(""));
  EXPECT_EQ(session_.Accept(Bytes(bad), 77'000, state_), FriAccept::kAccepted);
  EXPECT_TRUE(std::isnan(state_.q_meas[2]));
  EXPECT_FALSE(std::isnan(state_.q_meas[1]));
  EXPECT_EQ(state_.stamp, 77'000);
  EXPECT_EQ(state_.session, control::SessionState::kCommandingActive) << "of the message before";
  EXPECT_EQ(state_.rejected, 1u);
  EXPECT_EQ(session_.last_error(), CodecError::kNotFinite);
  EXPECT_TRUE(
      session_.Answer(control::ArmCommand{.q = state_.q_ipo, .activation = state_.activation}).empty());
  // the next valid message is accepted, so the session continues
  ASSERT_EQ(AcceptMessage(3, fri::COMMANDING_ACTIVE), FriAccept::kAccepted);
  EXPECT_EQ(state_.lost, 1u);

  // a message in which any other value is not a number must still be refused
  fri::FRIMonitoringMessage torque = Monitoring(4, fri::COMMANDING_ACTIVE);
  torque.mutable_monitordata()->mutable_measuredtorque()->set_value(2, std::nan(""));
  EXPECT_EQ(session_.Accept(Bytes(torque), 78'000, state_), FriAccept::kRejected);
  EXPECT_NE(state_.stamp, 78'000);
}

}  // namespace
}  // namespace osteon::io
