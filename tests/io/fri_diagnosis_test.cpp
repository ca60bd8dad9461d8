#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/io/fri_session_fixture.h"

// What keeps the arm from being commanded, in words.

namespace osteon::io {
namespace {

using control::ArmState;
using test::Bytes;
using test::Datagram;
using test::Monitoring;

constexpr std::array kFamilies{FriVersion::k1_15, FriVersion::k2_5, FriVersion::k2_7};  // one of each

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

TEST_F(FriSessionTest, DiagnosisNamesWhatKeepsTheArmFromMoving) {
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

}  // namespace
}  // namespace osteon::io
