#include "io/fri/fri_session.h"

#include <limits>

#include <gtest/gtest.h>

#include "control/rt/no_alloc_scope.h"
#include "tests/io/fri_oracle.h"

namespace osteon::io {
namespace {

using control::ArmCommand;
using control::ArmState;
using test::Bytes;
using test::Joints;
using test::Monitoring;

class FriSessionTest : public ::testing::Test {
 protected:
  FriAccept Take(std::uint32_t sequence, fri::SessionState state = fri::MONITORING_READY) {
    return session_.Accept(Bytes(Monitoring(sequence, state)), ++now_, state_);
  }
  // The answer as the arm would read it.
  fri::FRICommandMessage Answer(const control::JointArray& q) {
    const auto bytes = session_.Answer(ArmCommand{q});
    fri::FRICommandMessage answer;
    EXPECT_TRUE(answer.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    return answer;
  }
  static control::JointArray Position(const fri::FRICommandMessage& answer) {
    control::JointArray q{};
    EXPECT_EQ(answer.commanddata().jointposition().value_size(), 7);
    std::copy(answer.commanddata().jointposition().value().begin(),
              answer.commanddata().jointposition().value().end(), q.begin());
    return q;
  }

  FriSession session_;
  ArmState state_;
  rt::Nanoseconds now_{1000};
};

TEST_F(FriSessionTest, StateIsTheMessage) {
  fri::FRIMonitoringMessage m = Monitoring(77, fri::COMMANDING_ACTIVE);
  m.mutable_connectioninfo()->set_sendperiod(2);
  m.mutable_robotinfo()->set_safetystate(fri::STOP_LEVEL_2);
  ASSERT_EQ(session_.Accept(Bytes(m), 123, state_), FriAccept::kAccepted);
  EXPECT_EQ(state_.stamp, 123);
  EXPECT_EQ(state_.sequence, 77u);
  EXPECT_EQ(state_.session, control::SessionState::kCommandingActive);
  EXPECT_EQ(state_.quality, 3);
  EXPECT_EQ(state_.safety_state, 3);
  EXPECT_DOUBLE_EQ(state_.period_s, 0.002);
  EXPECT_EQ(state_.q_meas, Joints(0.1));
  EXPECT_TRUE(state_.has_ipo);
  EXPECT_EQ(state_.q_ipo, Joints(0.3));
  EXPECT_EQ(state_.tau_ext, Joints(-3.0));
}

TEST_F(FriSessionTest, OwesWhatTheSessionStateSays) {
  const auto q = Joints(0.9);
  Take(0, fri::IDLE);
  EXPECT_TRUE(session_.Answer(ArmCommand{q}).empty());
  Take(1, fri::MONITORING_WAIT);
  EXPECT_EQ(Position(Answer(q)), Joints(0.2)) << "mirrors the commanded position";
  Take(2, fri::MONITORING_READY);
  EXPECT_EQ(Position(Answer(q)), Joints(0.2));
  Take(3, fri::COMMANDING_WAIT);
  EXPECT_EQ(Position(Answer(q)), Joints(0.3)) << "mirrors the interpolator";
  Take(4, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(q)), q);
}

TEST_F(FriSessionTest, SendsTheHeaderAloneWhereThereIsNothingToMirror) {
  fri::FRIMonitoringMessage m = Monitoring(1, fri::MONITORING_READY);
  m.mutable_monitordata()->clear_commandedjointposition();
  session_.Accept(Bytes(m), 1, state_);
  const auto answer = Answer(Joints(0.9));
  EXPECT_FALSE(answer.has_commanddata());
  EXPECT_EQ(answer.header().reflectedsequencecounter(), 1u);
}

TEST_F(FriSessionTest, SendsAWrenchOrTorqueWhereTheArmAsksForOne) {
  fri::FRIMonitoringMessage m = Monitoring(1, fri::COMMANDING_WAIT);
  m.mutable_ipodata()->set_clientcommandmode(fri::WRENCH);
  session_.Accept(Bytes(m), 1, state_);
  const auto wrench = Answer(Joints(0.9));
  ASSERT_EQ(wrench.commanddata().cartesianwrenchfeedforward().element_size(), 6);
  EXPECT_EQ(wrench.commanddata().cartesianwrenchfeedforward().element(2), 0.0);
  m = Monitoring(2, fri::COMMANDING_ACTIVE);
  m.mutable_ipodata()->set_clientcommandmode(fri::TORQUE);
  session_.Accept(Bytes(m), 2, state_);
  EXPECT_EQ(Answer(Joints(0.9)).commanddata().jointtorque().value_size(), 7);
}

TEST_F(FriSessionTest, ReflectsTheArmsCounterAndCountsItsOwn) {
  for (std::uint32_t i = 0; i < 3; ++i) {
    Take(100 + i);
    const auto answer = Answer(Joints(0.9));
    EXPECT_EQ(answer.header().sequencecounter(), i);
    EXPECT_EQ(answer.header().reflectedsequencecounter(), 100 + i);
    EXPECT_TRUE(session_.Answer(ArmCommand{}).empty()) << "one answer a message";
  }
}

TEST_F(FriSessionTest, AnswersEveryMultiplierthMessageOfTheArm) {
  std::vector<std::uint32_t> answered;
  for (const std::uint32_t sequence : {0u, 1u, 2u, 3u, 4u, 6u, 7u, 8u}) {  // 5 is lost
    fri::FRIMonitoringMessage m = Monitoring(sequence, fri::MONITORING_READY);
    m.mutable_connectioninfo()->set_receivemultiplier(3);
    session_.Accept(Bytes(m), 1, state_);
    if (!session_.Answer(ArmCommand{}).empty()) answered.push_back(sequence);
  }
  EXPECT_EQ(answered, (std::vector<std::uint32_t>{2, 6})) << "the lost message counts for the arm's rhythm";
}

TEST_F(FriSessionTest, HoldsTheLastPositionWhereTheCommandIsNotFinite) {
  Take(1, fri::COMMANDING_WAIT);
  (void)Answer(Joints(0.0));
  auto bad = Joints(0.5);
  bad[6] = std::numeric_limits<double>::quiet_NaN();
  Take(2, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3)) << "what COMMANDING_WAIT mirrored";
  Take(3, fri::COMMANDING_ACTIVE);
  (void)Answer(Joints(0.4));
  Take(4, fri::COMMANDING_ACTIVE);
  bad[6] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Position(Answer(bad)), Joints(0.4));
}

// What was sent to another arm, or to this one before it moved by itself, is nothing to hold.
TEST_F(FriSessionTest, ANewSessionHoldsNothingOfTheOneBefore) {
  control::JointArray bad{};
  bad.fill(std::numeric_limits<double>::quiet_NaN());
  Take(1000, fri::COMMANDING_ACTIVE);
  ASSERT_EQ(Position(Answer(Joints(0.9))), Joints(0.9));
  session_.StartOver();
  Take(5, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3)) << "the interpolator's";
}

TEST_F(FriSessionTest, HoldsTheInterpolatorWhereTheFirstCommandOfAllIsNotFinite) {
  Take(1, fri::COMMANDING_ACTIVE);
  control::JointArray bad{};
  bad.fill(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Position(Answer(bad)), Joints(0.3));
}

TEST_F(FriSessionTest, CountsLossDuplicatesAndReordering) {
  EXPECT_EQ(Take(10), FriAccept::kAccepted);
  EXPECT_EQ(Take(11), FriAccept::kAccepted);
  EXPECT_EQ(Take(11), FriAccept::kDuplicate);
  EXPECT_EQ(Take(15), FriAccept::kAccepted);  // 12, 13, 14 missing
  EXPECT_EQ(state_.lost, 3u);
  EXPECT_EQ(Take(13), FriAccept::kLate);  // came after all
  EXPECT_EQ(Take(13), FriAccept::kDuplicate);
  EXPECT_EQ(Take(10), FriAccept::kDuplicate);
  EXPECT_EQ(state_.sequence, 15u) << "never goes back";
  EXPECT_EQ(state_.lost, 2u);
  EXPECT_EQ(state_.late, 1u);
  EXPECT_EQ(state_.duplicate, 3u);
  EXPECT_EQ(state_.rejected, 0u);
}

TEST_F(FriSessionTest, CountsAcrossTheCountersWrap) {
  Take(0xfffffffeu);
  EXPECT_EQ(Take(0xffffffffu), FriAccept::kAccepted);
  EXPECT_EQ(Take(1), FriAccept::kAccepted);
  EXPECT_EQ(state_.lost, 1u);
  EXPECT_EQ(Take(0), FriAccept::kLate);
  EXPECT_EQ(state_.lost, 0u);
}

TEST_F(FriSessionTest, ANewSessionOfTheArmBeginsInMonitoringOnly) {
  Take(5000, fri::COMMANDING_ACTIVE);
  EXPECT_EQ(Take(3, fri::COMMANDING_ACTIVE), FriAccept::kLate) << "an old command state must not come back";
  EXPECT_EQ(Take(4, fri::MONITORING_WAIT), FriAccept::kAccepted);
  EXPECT_EQ(state_.sequence, 4u);
  EXPECT_EQ(state_.lost, 0u);
  EXPECT_EQ(Take(5), FriAccept::kAccepted);
}

TEST_F(FriSessionTest, CountsAndExplainsWhatItRejects) {
  const std::vector<std::uint8_t> noise{1, 2, 3};
  EXPECT_EQ(session_.Accept(noise, 1, state_), FriAccept::kRejected);
  EXPECT_EQ(session_.last_error(), CodecError::kMalformed);
  EXPECT_EQ(state_.rejected, 1u);
  EXPECT_EQ(state_.stamp, 0);
  EXPECT_TRUE(session_.Answer(ArmCommand{}).empty()) << "noise is not answered";
}

TEST_F(FriSessionTest, DoesNotAllocate) {
  const auto bytes = Bytes(Monitoring(8, fri::COMMANDING_ACTIVE));
  rt::NoAllocScope scope;
  session_.Accept(bytes, 1, state_);
  const std::size_t size = session_.Answer(ArmCommand{state_.q_ipo}).size();
  EXPECT_EQ(scope.heap_calls(), 0);
  EXPECT_EQ(scope.locks(), 0);
  EXPECT_EQ(size, 77u);
}

}  // namespace
}  // namespace osteon::io
