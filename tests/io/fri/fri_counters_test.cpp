#include <vector>

#include <gtest/gtest.h>

#include "tests/io/fri/fri_session_fixture.h"

// Tests how FriSession counts messages and answers that were lost or doubled, that overtook others, or that
// belong to another client.

namespace osteon::io {
namespace {

using control::ArmCommand;
using test::Bytes;
using test::Joints;
using test::Monitoring;

TEST_F(FriSessionTest, CountsAnswersThatTheArmDidNotReceive) {
  // accepts a message that reflects this answer of the session; returns the number of the next answer
  const auto exchange = [&](std::uint32_t sequence, std::uint32_t reflected) {
    fri::FRIMonitoringMessage m = Monitoring(sequence, fri::MONITORING_READY);
    m.mutable_header()->set_reflectedsequencecounter(reflected);
    EXPECT_EQ(session_.Accept(Bytes(m), 1, state_), FriAccept::kAccepted);
    return Answer(Joints(0.0)).header().sequencecounter();
  };
  EXPECT_EQ(exchange(10, 0), 1u);  // the arm has received no answer of the session
  EXPECT_EQ(exchange(11, 0), 2u);
  EXPECT_EQ(exchange(12, 2), 3u);  // answer 1 was lost
  EXPECT_EQ(state_.answers_lost, 1u);
  EXPECT_EQ(exchange(13, 3), 4u);
  EXPECT_EQ(exchange(14, 3), 5u);
  EXPECT_EQ(exchange(15, 3), 6u);
  EXPECT_EQ(state_.answers_lost, 1u) << "they may be on their way";
  EXPECT_EQ(exchange(16, 6), 7u);
  EXPECT_EQ(state_.answers_lost, 3u);
  EXPECT_EQ(state_.answers_foreign, 0u);
  EXPECT_EQ(exchange(17, 900), 8u);  // an answer that the session never sent
  EXPECT_EQ(exchange(18, 2), 9u);    // an older answer than before
  EXPECT_EQ(state_.answers_foreign, 2u);
  EXPECT_EQ(exchange(19, 9), 10u);
  EXPECT_EQ(state_.answers_lost, 5u);
  EXPECT_NE(session_.Diagnosis().find("another client"), std::string::npos);
}

TEST_F(FriSessionTest, ReflectsTheArmsCounterAndNumbersItsAnswers) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    AcceptMessage(100 + i);
    const auto answer = Answer(Joints(0.9));
    EXPECT_EQ(answer.header().sequencecounter(), 1 + i);
    EXPECT_EQ(answer.header().reflectedsequencecounter(), 100 + i);
    EXPECT_TRUE(session_.Answer(ArmCommand{}).empty()) << "one answer a message";
  }
}

TEST_F(FriSessionTest, AnswersOnlyEveryThirdMessageIfTheMultiplierIsThree) {
  std::vector<std::uint32_t> answered;
  for (const std::uint32_t sequence : {0u, 1u, 2u, 3u, 4u, 6u, 7u, 8u}) {  // message 5 is lost
    fri::FRIMonitoringMessage m = Monitoring(sequence, fri::MONITORING_READY);
    m.mutable_connectioninfo()->set_receivemultiplier(3);
    session_.Accept(Bytes(m), 1, state_);
    if (!session_.Answer(ArmCommand{}).empty()) answered.push_back(sequence);
  }
  EXPECT_EQ(answered, (std::vector<std::uint32_t>{2, 6})) << "the lost message counts for the arm's rhythm";
}

TEST_F(FriSessionTest, CountsLossDuplicatesAndReordering) {
  EXPECT_EQ(AcceptMessage(10), FriAccept::kAccepted);
  EXPECT_EQ(AcceptMessage(11), FriAccept::kAccepted);
  EXPECT_EQ(AcceptMessage(11), FriAccept::kDuplicate);
  EXPECT_EQ(AcceptMessage(15), FriAccept::kAccepted);  // messages 12, 13 and 14 are missing
  EXPECT_EQ(state_.lost, 3u);
  EXPECT_EQ(AcceptMessage(13), FriAccept::kReordered);  // one of the missing messages arrives late
  EXPECT_EQ(AcceptMessage(13), FriAccept::kDuplicate);
  EXPECT_EQ(AcceptMessage(10), FriAccept::kDuplicate);
  EXPECT_EQ(state_.sequence, 15u) << "never goes back";
  EXPECT_EQ(state_.lost, 2u);
  EXPECT_EQ(state_.reordered, 1u);
  EXPECT_EQ(state_.late, 0u);
  EXPECT_EQ(state_.duplicate, 3u);
  EXPECT_EQ(state_.rejected, 0u);
}

TEST_F(FriSessionTest, CountsLossesAcrossTheCountersWrap) {
  AcceptMessage(0xfffffffeu);
  EXPECT_EQ(AcceptMessage(0xffffffffu), FriAccept::kAccepted);
  EXPECT_EQ(AcceptMessage(1), FriAccept::kAccepted);
  EXPECT_EQ(state_.lost, 1u);
  EXPECT_EQ(AcceptMessage(0), FriAccept::kReordered);
  EXPECT_EQ(state_.lost, 0u);
}

TEST_F(FriSessionTest, OnlyAMonitoringMessageBeginsANewSessionOfTheArm) {
  AcceptMessage(5000, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(AcceptMessage(3, fri::COMMANDING_ACTIVE), FriAccept::kReordered)
      << "an old command state must not come back";
  EXPECT_EQ(AcceptMessage(4, fri::MONITORING_WAIT), FriAccept::kAccepted);
  EXPECT_EQ(state_.sequence, 4u);
  EXPECT_EQ(state_.lost, 0u);
  EXPECT_EQ(AcceptMessage(5), FriAccept::kAccepted);
}

TEST_F(FriSessionTest, CountsRejectedMessagesAndKeepsTheReason) {
  const std::vector<std::uint8_t> noise{1, 2, 3};
  EXPECT_EQ(session_.Accept(noise, 1, state_), FriAccept::kRejected);
  EXPECT_EQ(session_.last_error(), CodecError::kMalformed);
  EXPECT_EQ(state_.rejected, 1u);
  EXPECT_EQ(state_.stamp, 0);
  EXPECT_TRUE(session_.Answer(ArmCommand{}).empty()) << "noise is not answered";
}

}  // namespace
}  // namespace osteon::io
