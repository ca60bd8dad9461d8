#include "io/rsi/rsi_session.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/io/rsi/rsi_oracle.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::io {
namespace {

using control::ArmCommand;
using control::ArmState;
using control::SessionState;

constexpr double kDegree = std::numbers::pi / 180.0;

// A robot message with all axes measured within 1 deg of their set points.
std::string Robot(std::uint64_t ipoc, std::uint32_t delay = 0) {
  return R"(<Rob Type="KUKA"><AIPos A1="10.1" A2="-80.2" A3="70.3" A4="0.4" A5="50.5" A6="-5.6"/>)"
         R"(<ASPos A1="10" A2="-80" A3="70" A4="0" A5="50" A6="-5"/><Delay D=")" +
         std::to_string(delay) + "\"/><IPOC>" + std::to_string(ipoc) + "</IPOC></Rob>";
}

class RsiSessionTest : public ::testing::Test {
 protected:
  // Opens a session. An entry step of 180 deg accepts a first command at any distance from the start pose.
  void Open(RsiSessionParams params, double entry_step_deg = 180.0) {
    params.entry_step_deg = entry_step_deg;
    session_.emplace(params);
  }
  // Passes a robot message to the session, 4 ms after the previous message.
  RsiAccept AcceptNext(std::uint64_t ipoc, std::uint32_t delay = 0) {
    now_ += 4 * rt::kMillisecond;
    return session_->Accept(test::Bytes(Robot(ipoc, delay)), now_, state_);
  }
  // Commands A1 to a1_deg and keeps the other axes at their set points. @returns A1's correction in the
  // answer [deg], read by expat; NaN if there is no answer.
  double Answer(double a1_deg) {
    ArmCommand command{{a1_deg * kDegree, -80 * kDegree, 70 * kDegree, 0, 50 * kDegree, -5 * kDegree, 9.9}};
    command.activation = activation_.value_or(state_.activation);
    const auto bytes = session_->Answer(command);
    text_ = test::Text(bytes);
    if (bytes.empty()) return std::nan("");
    const auto read = test::ReadByExpat(text_);
    EXPECT_TRUE(read) << text_;
    return read ? std::stod(read->at("AK/A1")) : std::nan("");
  }
  // Passes the settling messages, whose answers hold no correction. @returns the IPOC of the next message.
  std::uint64_t Settle(std::uint64_t ipoc, int messages, int step = 4) {
    for (int i = 0; i < messages; ++i, ipoc += static_cast<std::uint64_t>(step)) {
      EXPECT_EQ(AcceptNext(ipoc), RsiAccept::kAccepted);
      EXPECT_EQ(Answer(12.0), 0.0);
    }
    return ipoc;
  }

  std::optional<RsiSession> session_{RsiSessionParams{.entry_step_deg = 180.0, .settle_messages = 2}};
  ArmState state_;
  rt::Nanoseconds now_{rt::kSecond};
  std::string text_;
  std::optional<std::uint32_t> activation_;  // the loop's activation, if it differs from the state's
};

TEST_F(RsiSessionTest, StateHoldsTheMessagesValues) {
  ASSERT_EQ(AcceptNext(1000), RsiAccept::kAccepted);
  EXPECT_EQ(state_.stamp, now_);
  EXPECT_EQ(state_.sequence, 1000u);
  EXPECT_EQ(state_.session, SessionState::kCommandingWait);
  EXPECT_EQ(state_.period_s, 0.004);
  EXPECT_DOUBLE_EQ(state_.q_meas[1], -80.2 * kDegree);
  EXPECT_DOUBLE_EQ(state_.q_ipo[1], -80.0 * kDegree) << "the set point, where the controller sends it";
  EXPECT_TRUE(state_.has_ipo);
  EXPECT_EQ(state_.q_meas[6], 0.0);
}

// RSI's messages do not state their period: it is measured over 10 messages, and reported if it is at most
// half or at least twice the configured one.
TEST_F(RsiSessionTest, ReportsAMeasuredPeriodFarFromTheConfiguredOne) {
  struct Case {
    int configured_ms, actual_ms;
    double reported_s;
  };
  for (const auto& [configured_ms, actual_ms, reported_s] :
       {Case{4, 40, 0.040}, Case{12, 4, 0.004}, Case{4, 12, 0.012}, Case{4, 4, 0.004}, Case{12, 12, 0.012},
        Case{4, 7, 0.004}, Case{12, 7, 0.012}}) {
    RsiSession session({.cycle_ms = configured_ms, .settle_messages = 10});
    rt::Nanoseconds now = rt::kSecond;
    for (int i = 0; i < 30; ++i) {
      now += actual_ms * rt::kMillisecond;
      ASSERT_EQ(session.Accept(test::Bytes(Robot(1000 + 4 * static_cast<std::uint64_t>(i))), now, state_),
                RsiAccept::kAccepted);
      const double expected_s = i < 10 ? 1e-3 * configured_ms : reported_s;
      EXPECT_EQ(state_.period_s, expected_s) << configured_ms << " " << actual_ms << ", message " << i;
    }
  }
}

TEST_F(RsiSessionTest, AnswersEachMessageOnceWithItsIpoc) {
  EXPECT_TRUE(std::isnan(Answer(10.0))) << "never speaks first";
  ASSERT_EQ(AcceptNext(1000), RsiAccept::kAccepted);
  EXPECT_EQ(Answer(10.0), 0.0);
  EXPECT_NE(text_.find("<IPOC>1000</IPOC>"), std::string::npos);
  EXPECT_TRUE(std::isnan(Answer(10.0)));
}

TEST_F(RsiSessionTest, SettlesWithoutMotionThenCorrectsFromTheStart) {
  const std::uint64_t ipoc = Settle(1000, 2);
  ASSERT_EQ(AcceptNext(ipoc), RsiAccept::kAccepted);
  EXPECT_EQ(state_.session, SessionState::kCommandingActive);
  EXPECT_NEAR(Answer(12.5), 2.5, 1e-9);
  ASSERT_EQ(AcceptNext(ipoc + 4), RsiAccept::kAccepted);
  EXPECT_NEAR(Answer(12.75), 2.75, 1e-9) << "absolute: from the start, not from the last";
  EXPECT_NE(text_.find("A2=\"0.0000\" A3=\"0.0000\""), std::string::npos) << text_;
}

TEST_F(RsiSessionTest, RelativeCorrectionsAddUpWithoutRounding) {
  Open({.absolute = false, .settle_messages = 2});
  std::uint64_t ipoc = Settle(1000, 2);
  double sum = 0.0, wanted = 10.0;
  for (int i = 0; i < 3000; ++i, ipoc += 4) {
    wanted += 1.0 / 30000.0;  // a third of the last decimal: rounded alone, each step would be 0
    ASSERT_EQ(AcceptNext(ipoc), RsiAccept::kAccepted);
    sum += Answer(wanted);
  }
  EXPECT_NEAR(sum, 0.1, 0.5e-4 + 1e-9);
  EXPECT_NEAR(session_->status().sum[0], sum, 1e-9);
}

TEST_F(RsiSessionTest, RelativeSumCountsCyclesWithoutAnAnswer) {
  for (const bool hold_on : {false, true}) {
    Open({.absolute = false, .hold_on = hold_on, .settle_messages = 1});
    now_ += 10 * rt::kSecond;
    std::uint64_t ipoc = Settle(1000, 1);
    AcceptNext(ipoc);
    EXPECT_NEAR(Answer(11.0), 1.0, 1e-9);
    AcceptNext(ipoc += 4);  // RSI got the 1.0 in time
    EXPECT_NEAR(Answer(13.0), 2.0, 1e-9);
    AcceptNext(ipoc += 4, 1);  // RSI drops the late 2.0; with HOLDON it repeats the 1.0
    EXPECT_NEAR(Answer(13.0), hold_on ? 1.0 : 2.0, 1e-9);
    AcceptNext(ipoc += 12, 3);  // the last answer arrived in time; then the messages of two cycles were lost
    EXPECT_NEAR(Answer(13.0), hold_on ? -2.0 : 0.0, 1e-9);
    EXPECT_EQ(session_->status().delay, 3u);
  }
}

TEST_F(RsiSessionTest, CountsLostDuplicateAndReorderedMessagesByTheIpocStep) {
  for (const int step : {1, 4, 12}) {
    Open({.ipoc_step = step, .settle_messages = 1});
    const auto at = [&](int k) { return 1000 + static_cast<std::uint64_t>(k * step); };
    EXPECT_EQ(AcceptNext(at(0)), RsiAccept::kAccepted);
    EXPECT_EQ(AcceptNext(at(3)), RsiAccept::kAccepted);
    EXPECT_EQ(state_.lost, 2u);
    EXPECT_EQ(AcceptNext(at(2)), RsiAccept::kLate);
    EXPECT_EQ(state_.lost, 1u) << "it came after all";
    EXPECT_EQ(state_.reordered, 1u);
    EXPECT_EQ(state_.late, 0u);
    EXPECT_EQ(AcceptNext(at(2)), RsiAccept::kDuplicate);
    EXPECT_EQ(AcceptNext(at(3)), RsiAccept::kDuplicate);
    EXPECT_EQ(state_.duplicate, 2u);
    EXPECT_EQ(session_->Accept(test::Bytes("<Rob"), now_, state_), RsiAccept::kRejected);
    EXPECT_EQ(state_.rejected, 1u);
    EXPECT_EQ(session_->last_error().code, RsiErrorCode::kMalformed);
    EXPECT_EQ(AcceptNext(at(4)), RsiAccept::kAccepted);
  }
}

TEST_F(RsiSessionTest, RefusesAMessageWithoutMeasuredAxes) {
  EXPECT_EQ(session_->Accept(test::Bytes("<Rob Type=\"KUKA\"><IPOC>1</IPOC></Rob>"), 1, state_),
            RsiAccept::kRejected);
  EXPECT_EQ(Describe(session_->last_error()), "AIPos: is missing (byte 37)");
}

TEST_F(RsiSessionTest, RepeatsTheLastCorrectionInsteadOfAForbiddenOne) {
  Open({.settle_messages = 1, .range = {5, 90, 90, 90, 90, 90}});
  std::uint64_t ipoc = Settle(1000, 1);
  AcceptNext(ipoc);
  EXPECT_NEAR(Answer(14.0), 4.0, 1e-9);
  AcceptNext(ipoc += 4);
  EXPECT_NEAR(Answer(15.1), 4.0, 1e-9) << "beyond the range";
  EXPECT_EQ(session_->status().out_of_range, 1u);
  EXPECT_EQ(session_->status().worst, 1);
  AcceptNext(ipoc += 4);
  EXPECT_NEAR(Answer(std::nan("")), 4.0, 1e-9);
  EXPECT_EQ(session_->status().not_finite, 1u);
  AcceptNext(ipoc += 4);
  EXPECT_NEAR(Answer(5.0), -5.0, 1e-9) << "the bound itself";
}

TEST_F(RsiSessionTest, HoldsUntilACommandNamesTheActivationAndLiesNearTheStart) {
  Open({.settle_messages = 1}, 1.0);
  std::uint64_t ipoc = Settle(1000, 1);
  AcceptNext(ipoc);
  EXPECT_EQ(state_.activation, 1u);
  EXPECT_TRUE(state_.holding);
  activation_ = 0;
  EXPECT_EQ(Answer(10.5), 0.0) << "a command for another activation";
  activation_.reset();
  AcceptNext(ipoc += 4);
  EXPECT_EQ(Answer(12.5), 0.0) << "2.5 deg off the start";
  AcceptNext(ipoc += 4);
  EXPECT_TRUE(state_.holding);
  EXPECT_NEAR(Answer(10.5), 0.5, 1e-9);
  AcceptNext(ipoc += 4);
  EXPECT_FALSE(state_.holding);
  EXPECT_NEAR(Answer(12.5), 2.5, 1e-9);
  ipoc = Settle(500, 1);  // RSI restarted
  AcceptNext(ipoc);
  EXPECT_EQ(state_.activation, 2u);
  activation_ = 1;
  EXPECT_EQ(Answer(10.5), 0.0);
}

TEST_F(RsiSessionTest, NeverAnswersAnRsiThatWasAlreadyRunning) {
  EXPECT_EQ(AcceptNext(1000, 7), RsiAccept::kJoinedLate);
  EXPECT_TRUE(std::isnan(Answer(10.0)));
  EXPECT_EQ(AcceptNext(1004, 8), RsiAccept::kJoinedLate);
  EXPECT_TRUE(std::isnan(Answer(10.0)));
  EXPECT_EQ(state_.session, SessionState::kIdle);
  EXPECT_EQ(state_.rejected, 2u);
  EXPECT_EQ(AcceptNext(1040, 0), RsiAccept::kAccepted) << "RSI began anew";
  EXPECT_EQ(Answer(10.0), 0.0);
  EXPECT_EQ(session_->status().sessions, 1u);
}

TEST_F(RsiSessionTest, ToleratesTheConfiguredDelayAtTheStart) {
  Open({.settle_messages = 1, .late_at_start = 2});
  EXPECT_EQ(AcceptNext(1000, 3), RsiAccept::kJoinedLate);
  EXPECT_EQ(AcceptNext(1004, 2), RsiAccept::kAccepted);
  EXPECT_EQ(AcceptNext(1008, 3), RsiAccept::kAccepted) << "the start alone is judged";
  EXPECT_EQ(session_->status().sessions, 1u);
}

TEST_F(RsiSessionTest, StartsANewSessionWhenRsiRestarts) {
  // Settles, then commands a correction of 2 deg.
  const auto correct = [&](std::uint64_t ipoc) {
    ipoc = Settle(ipoc, 2);
    AcceptNext(ipoc);
    EXPECT_NEAR(Answer(12.0), 2.0, 1e-9);
    return ipoc;
  };
  std::uint64_t ipoc = correct(1'000'000);
  ipoc = correct(500);             // IPOC has fallen far back
  ipoc = correct(ipoc + 101 * 4);  // IPOC has leapt by more than the Timeout
  now_ += 400 * rt::kMillisecond;  // silence for as long as the Timeout
  correct(ipoc + 4);
  EXPECT_EQ(session_->status().sessions, 4u);
  EXPECT_EQ(state_.lost, 0u);
}

// Once the end is requested, the answer repeats the last correction.
TEST_F(RsiSessionTest, RequestsTheEndOfRsiInTheKroshuLayout) {
  Open({.layout = RsiLayout::kKroshu, .settle_messages = 1});
  std::uint64_t ipoc = Settle(1000, 1);
  AcceptNext(ipoc);
  Answer(11.0);
  EXPECT_NE(text_.find("<Stop>0</Stop><AK A1=\"1.000000\""), std::string::npos) << text_;
  session_->RequestStop();
  AcceptNext(ipoc + 4);
  Answer(17.0);
  EXPECT_NE(text_.find("<Stop>1</Stop><AK A1=\"1.000000\""), std::string::npos) << text_;
}

// A1 goes from 10 to 30 deg about the base's -z: the expected displacement is a turn by -20 deg about z.
TEST_F(RsiSessionTest, CartesianCorrectionIsTheFlangesDisplacement) {
  Open({.kind = RsiCorrection::kCartesian,
        .settle_messages = 1,
        .range = {500, 500, 500, 90, 90, 90},
        .arm = kinematics::Kr6R900Params()});
  AcceptNext(1000);
  (void)session_->Answer({});
  AcceptNext(1004);
  ArmCommand command{{30 * kDegree, -80 * kDegree, 70 * kDegree, 0, 50 * kDegree, -5 * kDegree}};
  command.activation = state_.activation;
  const auto read = test::ReadByExpat(test::Text(session_->Answer(command)));
  ASSERT_TRUE(read);
  const kinematics::SerialChain<6> chain(kinematics::ChainFrom(kinematics::Kr6R900Params()));
  kinematics::JointVectorN<6> q;
  q << 10, -80, 70, 0, 50, -5;
  const Vector3 p = chain.FlangePose(kDegree * q).translation();
  const Vector3 moved = 1e3 * (Eigen::AngleAxisd(-20 * kDegree, Vector3::UnitZ()) * p - p);
  EXPECT_NEAR(std::stod(read->at("RKorr/X")), moved.x(), 1e-4);
  EXPECT_NEAR(std::stod(read->at("RKorr/Y")), moved.y(), 1e-4);
  EXPECT_NEAR(std::stod(read->at("RKorr/Z")), 0.0, 1e-4);
  EXPECT_NEAR(std::stod(read->at("RKorr/A")), -20.0, 1e-4);
  EXPECT_NEAR(std::stod(read->at("RKorr/B")), 0.0, 1e-4);
  EXPECT_NEAR(std::stod(read->at("RKorr/C")), 0.0, 1e-4);
}

TEST_F(RsiSessionTest, RefusesParametersByName) {
  const auto refused = [](const RsiSessionParams& params) -> std::string {
    try {
      RsiSession session(params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refused({.cycle_ms = 5}).find("cycle_ms: found 5"), std::string::npos);
  EXPECT_NE(refused({.ipoc_step = 0}).find("ipoc_step: found 0"), std::string::npos);
  EXPECT_NE(refused({.timeout_cycles = 0}).find("timeout_cycles"), std::string::npos);
  EXPECT_NE(refused({.entry_step_deg = 0}).find("entry_step_deg"), std::string::npos);
  EXPECT_NE(refused({.late_at_start = -1}).find("late_at_start: found -1"), std::string::npos);
  EXPECT_NE(refused({.settle_messages = 0}).find("settle_messages"), std::string::npos);
  EXPECT_NE(refused({.range = {1, 1, 0, 1, 1, 1}}).find("range 3: found 0"), std::string::npos);
  EXPECT_NE(refused({.decimals = 10}).find("decimals"), std::string::npos);
  EXPECT_NE(refused({.kind = RsiCorrection::kCartesian}).find("params.arm"), std::string::npos);
  EXPECT_EQ(refused({.cycle_ms = 12}), "accepted");
}

TEST_F(RsiSessionTest, DoesNotAllocate) {
  std::vector<std::vector<std::uint8_t>> messages;
  for (std::uint64_t k = 0; k < 50; ++k) messages.push_back(test::Bytes(Robot(1000 + 4 * k, k > 20 ? 1 : 0)));
  messages[30] = test::Bytes("<Rob><AIPos");
  for (const RsiCorrection kind : {RsiCorrection::kAxes, RsiCorrection::kCartesian}) {
    RsiSession session({.kind = kind, .absolute = false, .arm = kinematics::Kr6R900Params()});
    std::size_t answered = 0;
    rt::CheckedNoAllocScope no_alloc;
    for (const auto& message : messages) {
      now_ += 4 * rt::kMillisecond;
      session.Accept(message, now_, state_);
      answered += session.Answer({state_.q_meas}).empty() ? 0 : 1;
    }
    no_alloc.End();
    EXPECT_EQ(answered, 49u);
  }
}

}  // namespace
}  // namespace osteon::io
