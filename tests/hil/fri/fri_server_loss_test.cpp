#include <gtest/gtest.h>

#include "tests/hil/fri/fri_server_bench.h"

// Tests the FRI server: which answers of the client count, and what happens if answers are missing.

namespace osteon::hil {
namespace {

using control::SessionState;
using kinematics::JointVector;

TEST(FriServer, EndsCommandingAtTheFifthLostAnswerInARow) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.client.offset.fill(5e-4);
  s.Cycle();
  for (int i = 0; i < 4; ++i) s.Cycle(false);
  s.Cycle();
  for (int i = 0; i < 4; ++i) s.Cycle(false);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  s.Cycle(false);
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringWait);
  EXPECT_EQ(s.server.stop().reason, StopReason::kLostInARow);
  EXPECT_EQ(s.server.stop().found, 5.0);
  EXPECT_TRUE(
      s.server.q_commanded().isApprox(JointVector::Constant(0.5005), 1e-15));  // the arm holds its position
  // with these parameters the robot's program does not request commanding again
  for (int i = 0; i < 2000; ++i) s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
}

TEST(FriServer, EndsCommandingAtTwentyFiveLostAnswersASecond) {
  for (const int losses : {24, 25}) {
    Session s;
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    for (int i = 0; i < losses; ++i) {
      s.Cycle(false);
      for (int k = 0; k < 30; ++k) s.Cycle();  // distributes the losses over 775 ms
    }
    EXPECT_EQ(s.server.state() == SessionState::kCommandingActive, losses == 24);
    EXPECT_EQ(s.server.stop().reason, losses == 24 ? StopReason::kNone : StopReason::kLostPerSecond);
  }
}

// Twenty losses per second may continue for any time, because each loss is forgotten after a second.
TEST(FriServer, LossesOfMoreThanASecondAgoAreForgotten) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5000; ++i) s.Cycle(i % 50 != 0);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.counters().lost, 100u);
  EXPECT_EQ(s.server.quality(), 1);  // quality FAIR
  for (int i = 0; i < 1000; ++i) s.Cycle();
  EXPECT_EQ(s.server.quality(), 3);
}

TEST(FriServer, CanRequestCommandingAgainAfterLosses) {
  Session s({.request_again_after_loss = true});
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5; ++i) s.Cycle(false);
  ASSERT_EQ(s.server.state(), SessionState::kMonitoringWait);
  EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
}

TEST(FriServer, ALateArmCountsNoLossesOfTheClient) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 100; ++i) s.Cycle(false, false);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.counters().lost, 0u);
  EXPECT_EQ(s.server.counters().excused, 100u);
}

TEST(FriServer, ClosesTheSessionIfQualityIsNotGoodWithinTenSeconds) {
  Session s;
  for (int i = 0; i < 9999; ++i) s.Cycle(i % 30 == 0);  // too few answers for the quality GOOD
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringWait);
  s.Cycle(false);
  EXPECT_EQ(s.server.state(), SessionState::kIdle);
  EXPECT_EQ(s.server.stop().reason, StopReason::kQualityTimeout);
  EXPECT_TRUE(s.message.empty());
  s.server.Open();
  s.Send();
  EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
}

TEST(FriServer, LateAndSecondAnswersDoNotCount) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  const Bytes late = s.client.Answer(s.message);
  s.Cycle(false);
  s.Cycle(late);
  EXPECT_EQ(s.server.counters().stale, 1u);
  EXPECT_EQ(s.server.counters().lost, 2u);
  const Bytes answer = s.client.Answer(s.message);
  s.server.Receive(answer);
  s.Cycle(answer);
  EXPECT_EQ(s.server.counters().duplicate, 1u);
  EXPECT_EQ(s.server.counters().lost, 2u);
  // an answer to a message that the server has never sent
  s.Cycle(Command(1, static_cast<std::uint32_t>(UintAt(s.message, {1, 2})) + 1, Start()));
  EXPECT_EQ(s.server.counters().malformed, 1u);
}

TEST(FriServer, OneAnswerInFiveIsEnoughAtMultiplierFive) {
  Session s({.receive_multiplier = 5});
  for (int i = 0; i < 4000; ++i) s.Cycle(i % 5 == 4);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.counters().lost, 0u);
  EXPECT_EQ(s.server.counters().answered, 800u);
  for (int i = 0; i < 24; ++i) s.Cycle(false);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  s.Cycle(false);
  EXPECT_EQ(s.server.stop().reason, StopReason::kLostInARow);
}

TEST(FriServer, AnAnswerWithoutJointsIsALossInCommandingStates) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5; ++i) s.Command({});
  EXPECT_EQ(s.server.counters().incomplete, 5u);
  EXPECT_EQ(s.server.stop().reason, StopReason::kLostInARow);
}

TEST(FriServer, CountsGapsAndBackstepsOfTheClientsCounter) {
  Session s;
  for (int i = 0; i < 5; ++i) s.Cycle();
  s.client.sequence += 3;
  s.Cycle();
  EXPECT_EQ(s.server.counters().client_gap, 3u);
  EXPECT_EQ(s.server.counters().client_back, 0u);
  s.client.sequence -= 2;
  s.Cycle();
  EXPECT_EQ(s.server.counters().client_back, 1u);
  s.Cycle();
  EXPECT_EQ(s.server.counters().client_gap + s.server.counters().client_back, 4u);
}

}  // namespace
}  // namespace osteon::hil
