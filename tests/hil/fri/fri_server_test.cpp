#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/hil/fri/fri_server_bench.h"

// Tests the FRI server: the states of the session, and the content of its messages. A field is named by its
// path of protobuf numbers: {4, 1} is field 1 within field 4.

namespace osteon::hil {
namespace {

using control::SessionState;
using kinematics::JointVector;

TEST(FriServer, WalksTheSessionStatesInOrder) {
  Session s;
  std::vector<SessionState> seen;
  for (int i = 0; i < 1000; ++i) {
    const auto sent_state = static_cast<SessionState>(UintAt(s.message, {4, 1}));
    EXPECT_EQ(sent_state, s.server.state());
    if (seen.empty() || seen.back() != sent_state) seen.push_back(sent_state);
    const bool commanding = sent_state >= SessionState::kCommandingWait;
    EXPECT_EQ(DoublesAt(s.message, {5, 1, 1}).size(), commanding ? 7u : 0u);
    EXPECT_EQ(DoublesAt(s.message, {5, 12}).front(),
              sent_state == SessionState::kCommandingActive ? 1.0 : 0.0);
    s.Cycle();
  }
  EXPECT_EQ(seen, (std::vector{SessionState::kMonitoringWait, SessionState::kMonitoringReady,
                               SessionState::kCommandingWait, SessionState::kCommandingActive}));
  EXPECT_EQ(s.server.counters().lost, 0u);
  EXPECT_EQ(s.server.counters().answered, 1000u);
  EXPECT_EQ(UintAt(s.message, {4, 2}), 3u);  // quality EXCELLENT
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
}

// After 50 answers the quality is GOOD. 200 cycles later the robot's program requests commanding. After 50
// more answers, which repeat the interpolator's position, the client commands.
TEST(FriServer, StatesChangeAfter50And200And50Cycles) {
  Session s;
  int cycles = 0;
  for (; s.server.state() == SessionState::kMonitoringWait; ++cycles) s.Cycle();
  EXPECT_EQ(cycles, 50);
  for (cycles = 0; s.server.state() == SessionState::kMonitoringReady; ++cycles) s.Cycle();
  EXPECT_EQ(cycles, 200);
  for (cycles = 0; s.server.state() == SessionState::kCommandingWait; ++cycles) s.Cycle();
  EXPECT_EQ(cycles, 50);
}

TEST(FriServer, ReflectsTheClientsCounterAndCountsItsOwn) {
  Session s;
  s.client.sequence = 0xfffffffd;  // the sequence number wraps around during the test
  for (int i = 0; i < 10; ++i) {
    const auto before = UintAt(s.message, {1, 2});
    s.Cycle();
    EXPECT_EQ(UintAt(s.message, {1, 2}), before + 1);
    EXPECT_EQ(UintAt(s.message, {1, 3}), s.client.sequence);
  }
}

TEST(FriServer, FollowsTheCommandOnlyWhenActive) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kMonitoringReady));
  s.Command(std::vector<double>(7, 0.9));  // the client commands a position before it is asked to
  EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.client.offset.fill(1e-3);
  s.Cycle();
  EXPECT_TRUE(s.server.q_commanded().isApprox(JointVector::Constant(0.501), 1e-15));
  EXPECT_EQ(DoublesAt(s.message, {5, 1, 1}), Start());  // the interpolator's position does not change
  EXPECT_DOUBLE_EQ(DoublesAt(s.message, {3, 3, 1}).front(), 0.501);
}

TEST(FriServer, ClosingTakesFiveSeconds) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.server.Close();
  for (int i = 0; i < 4999; ++i) s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
  s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kIdle);
  EXPECT_TRUE(s.message.empty());
  s.server.Open();
  s.Send();
  EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
}

// In a public log of a real arm, the session ends with messages in the state IDLE. By default, the simulated
// arm only stops sending.
TEST(FriServer, ASessionMayEndWithIdleMessages) {
  for (const SessionEnd end : {SessionEnd::kSilence, SessionEnd::kIdleMessages}) {
    Session s({.session_end = end});
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    s.server.CloseAfter(0.05);
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
    int ready = 0, idle = 0;
    for (s.Cycle(); !s.message.empty() && ready + idle < 1000; s.Cycle())
      ++(static_cast<SessionState>(UintAt(s.message, {4, 1})) == SessionState::kIdle ? idle : ready);
    EXPECT_EQ(ready, 49);
    EXPECT_EQ(idle, end == SessionEnd::kIdleMessages ? 10 : 0);
    EXPECT_EQ(s.server.state(), SessionState::kIdle);
    s.server.Open();
    s.Send();
    EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive))
        << "a session that is opened again says nothing of it";
  }
}

TEST(FriServer, TheExternalTorqueIsFilteredAndHasAnOffset) {
  FriServerParams params{.external_torque_cutoff_hz = 10.0};
  params.external_torque_offset_Nm[2] = 0.25;
  FriServer server(params, kinematics::Iiwa14().limits, JointVector::Constant(0.5));
  server.Open();
  const JointVector tau = JointVector::Constant(8.0);
  double read_Nm = 0.0;
  for (int i = 0; i < 16; ++i)  // 16 ms, the time constant 1 / (2 pi 10 Hz) = 15.9 ms
    read_Nm =
        DoublesAt(server.BeginCycle({.q = JointVector::Constant(0.5), .tau_ext = tau}, 1), {3, 5, 1})[0];
  EXPECT_NEAR(read_Nm, 8.0 * (1.0 - std::exp(-2.0 * 3.14159265358979 * 10.0 * 0.016)), 1e-9);
  const auto bytes = server.BeginCycle({.q = JointVector::Constant(0.5), .tau_meas = tau, .tau_ext = tau}, 1);
  EXPECT_NEAR(DoublesAt(bytes, {3, 5, 1})[2] - DoublesAt(bytes, {3, 5, 1})[0], 0.25, 1e-12);
  EXPECT_EQ(DoublesAt(bytes, {3, 2, 1})[0], 8.0) << "the measured torque is not filtered";
}

TEST(FriServer, ReachesCommandingWithThePeriodsAndMultipliersOfRealArms) {
  for (const int period_ms : {1, 2, 5, 10})
    for (const int multiplier : {1, 2, 5}) {
      FriServerParams params{.send_period_ms = period_ms, .receive_multiplier = multiplier};
      const int due = 1000 / (period_ms * multiplier);
      params.quality.fair_after_answers = std::min(10, due / 2);
      params.quality.good_after_answers = std::min(50, due / 2);
      params.quality.excellent_after_answers = std::min(90, due);
      Session s(params);
      for (int i = 1; i < 6000 && s.server.state() != SessionState::kCommandingActive; ++i)
        s.Cycle(i % multiplier == 0);
      EXPECT_EQ(s.server.state(), SessionState::kCommandingActive) << period_ms << " ms, " << multiplier;
      EXPECT_EQ(s.server.counters().lost, 0u);
      EXPECT_EQ(UintAt(s.message, {4, 3}), static_cast<std::uint64_t>(period_ms));
      EXPECT_EQ(UintAt(s.message, {4, 4}), static_cast<std::uint64_t>(multiplier));
    }
}

TEST(FriServer, HostileBytesChangeNothingButACounter) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  std::mt19937 random(7);
  for (int i = 0; i < 5000; ++i) {
    Bytes junk(random() % 200);
    for (auto& b : junk) b = static_cast<std::uint8_t>(random());
    EXPECT_FALSE(s.server.Receive(junk));
    s.Cycle();
  }
  EXPECT_EQ(s.server.counters().malformed, 5000u);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
}

TEST(FriServer, RefusesParametersOutOfRange) {
  const JointVector q = JointVector::Constant(0.5);
  const auto make = [&](const FriServerParams& p) { FriServer server(p, kinematics::Iiwa14().limits, q); };
  EXPECT_NO_THROW(make({}));
  EXPECT_NO_THROW(make({.send_period_ms = 10}));
  EXPECT_THROW(make({.send_period_ms = 0}), std::invalid_argument);
  EXPECT_THROW(make({.receive_multiplier = 0}), std::invalid_argument);
  EXPECT_THROW(make({.step_margin = 0.5}), std::invalid_argument);
  EXPECT_THROW(make({.command_mode = control::CommandMode::kCartesianPose}), std::invalid_argument);
  EXPECT_THROW(make({.max_axis_delta_rad = 0.0}), std::invalid_argument);
  EXPECT_THROW(make({.close_s = -1.0}), std::invalid_argument);
  EXPECT_THROW(make({.external_torque_cutoff_hz = -1.0}), std::invalid_argument);
  EXPECT_THROW(make({.send_period_ms = 20}),
               std::invalid_argument);  // 50 answers per second can never give the quality EXCELLENT
  EXPECT_THROW(FriServer({}, kinematics::Iiwa14().limits, JointVector::Constant(2.2)), std::invalid_argument);
  EXPECT_THROW(FriServer({}, {}, q), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
