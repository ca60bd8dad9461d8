#include "hil/fri_server.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "test_client.h"

namespace osteon::hil {
namespace {

using control::SessionState;
using kinematics::JointVector;

// An arm that is where it is told to be, and a client that answers when asked to.
struct Session {
  explicit Session(const FriServerParams& params = {},
                   const JointVector& q_start = JointVector::Constant(0.5))
      : server(params, kinematics::Iiwa14().limits, q_start) {
    server.Open();
    Send();
  }

  void Send() {
    const auto bytes = server.BeginCycle({.q = server.q_commanded()}, ++cycles * rt::kMillisecond);
    message.assign(bytes.begin(), bytes.end());
  }
  void Cycle(bool answer = true, bool had_its_time = true) {
    if (answer) server.Receive(client.Answer(message));
    server.EndCycle(had_its_time);
    Send();
  }
  void Cycle(const Bytes& answer) {
    server.Receive(answer);
    server.EndCycle();
    Send();
  }
  // Sends this joint position as the answer to the present message.
  void Command(std::vector<double> q) {
    Cycle(hil::Command(++client.sequence, static_cast<std::uint32_t>(UintAt(message, {1, 2})), q));
  }
  bool WalkTo(SessionState state) {
    for (int i = 0; i < 2000 && server.state() != state; ++i) Cycle();
    return server.state() == state;
  }

  FriServer server;
  TestClient client;
  Bytes message;
  rt::Nanoseconds cycles{0};
};

std::vector<double> Start() { return std::vector<double>(7, 0.5); }

TEST(FriServer, WalksTheSessionStatesInOrder) {
  Session s;
  std::vector<SessionState> seen;
  for (int i = 0; i < 1000; ++i) {
    const auto told = static_cast<SessionState>(UintAt(s.message, {4, 1}));
    EXPECT_EQ(told, s.server.state());
    if (seen.empty() || seen.back() != told) seen.push_back(told);
    const bool commanding = told >= SessionState::kCommandingWait;
    EXPECT_EQ(DoublesAt(s.message, {5, 1, 1}).size(), commanding ? 7u : 0u);
    EXPECT_EQ(DoublesAt(s.message, {5, 12}).front(), told == SessionState::kCommandingActive ? 1.0 : 0.0);
    s.Cycle();
  }
  EXPECT_EQ(seen, (std::vector{SessionState::kMonitoringWait, SessionState::kMonitoringReady,
                               SessionState::kCommandingWait, SessionState::kCommandingActive}));
  EXPECT_EQ(s.server.counters().lost, 0u);
  EXPECT_EQ(s.server.counters().answered, 1000u);
  EXPECT_EQ(UintAt(s.message, {4, 2}), 3u);  // EXCELLENT
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
}

// 50 answers make GOOD, 200 further cycles the request, 50 mirrored answers the hand-over.
TEST(FriServer, StatesChangeAfterTheStatedCycles) {
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
  s.client.sequence = 0xfffffffd;  // wraps within the test
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
  s.Command(std::vector<double>(7, 0.9));  // not asked for
  EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.client.offset.fill(1e-3);
  s.Cycle();
  EXPECT_TRUE(s.server.q_commanded().isApprox(JointVector::Constant(0.501), 1e-15));
  EXPECT_EQ(DoublesAt(s.message, {5, 1, 1}), Start());  // the interpolator rests
  EXPECT_DOUBLE_EQ(DoublesAt(s.message, {3, 3, 1}).front(), 0.501);
}

TEST(FriServer, EndsCommandingAtTheFifthLostInARowAndNotBefore) {
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
  EXPECT_TRUE(s.server.q_commanded().isApprox(JointVector::Constant(0.5005), 1e-15));  // holds
  // the program does not ask again
  for (int i = 0; i < 2000; ++i) s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
}

TEST(FriServer, EndsCommandingAtTwentyFiveLostASecondAndNotAtTwentyFour) {
  for (const int losses : {24, 25}) {
    Session s;
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    for (int i = 0; i < losses; ++i) {
      s.Cycle(false);
      for (int k = 0; k < 30; ++k) s.Cycle();  // spread over 775 ms
    }
    EXPECT_EQ(s.server.state() == SessionState::kCommandingActive, losses == 24);
    EXPECT_EQ(s.server.stop().reason, losses == 24 ? StopReason::kNone : StopReason::kLostPerSecond);
  }
}

// 20 a second, for ever: each is forgotten after a second.
TEST(FriServer, LossesOfMoreThanASecondAgoAreForgotten) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5000; ++i) s.Cycle(i % 50 != 0);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.counters().lost, 100u);
  EXPECT_EQ(s.server.quality(), 1);  // FAIR
  for (int i = 0; i < 1000; ++i) s.Cycle();
  EXPECT_EQ(s.server.quality(), 3);
}

TEST(FriServer, MayAskAgainAfterLosses) {
  Session s({.request_again_after_loss = true});
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5; ++i) s.Cycle(false);
  ASSERT_EQ(s.server.state(), SessionState::kMonitoringWait);
  EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
}

TEST(FriServer, LatenessOfTheArmIsNotHeldAgainstTheClient) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 100; ++i) s.Cycle(false, false);
  EXPECT_EQ(s.server.state(), SessionState::kCommandingActive);
  EXPECT_EQ(s.server.counters().lost, 0u);
  EXPECT_EQ(s.server.counters().excused, 100u);
}

TEST(FriServer, ClosesTheSessionWhereQualityDoesNotComeWithinTenSeconds) {
  Session s;
  for (int i = 0; i < 9999; ++i) s.Cycle(i % 30 == 0);  // too few to be GOOD
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
  // an answer to a message that was never sent
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

TEST(FriServer, AnswerWithoutJointsIsNoneInCommandingStates) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  for (int i = 0; i < 5; ++i) s.Command({});
  EXPECT_EQ(s.server.counters().incomplete, 5u);
  EXPECT_EQ(s.server.stop().reason, StopReason::kLostInARow);
}

// One illegal command each; the arm must stop for this reason, name the joint, and stay where it was.
void ExpectStop(const std::vector<double>& q, StopReason reason, int joint, const std::string& text,
                SessionState from = SessionState::kCommandingActive) {
  Session s;
  ASSERT_TRUE(s.WalkTo(from));
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, reason);
  EXPECT_EQ(s.server.stop().joint, joint);
  EXPECT_NE(Describe(s.server.stop()).find(text), std::string::npos) << Describe(s.server.stop());
  EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
  EXPECT_EQ(UintAt(s.message, {2, 2}), 2u);  // STOP_LEVEL_1
  EXPECT_EQ(UintAt(s.message, {2, 5}), 0u);  // drives off
  // the stop lasts, however well the client answers
  for (int i = 0; i < 1000; ++i) s.Cycle();
  EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
  EXPECT_EQ(UintAt(s.message, {2, 2}), 2u);
}

TEST(FriServer, StopsOnAnIllegalCommand) {
  auto q = Start();
  q[3] += 75.0 * 3.14159265358979 / 180.0 * 1e-3 * 1.1 + 1e-6;  // A4: 75 deg/s for 1 ms, margin 1.1
  ExpectStop(q, StopReason::kJointStep, 4, "joint step: A4");
  q = Start();
  q[1] = 2.1;  // A2: 120 deg = 2.0944 rad
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

// A stop is taken back by its acknowledgement; the drives need their half second, then the program asks
// again.
TEST(FriServer, AfterAStopTheArmIgnoresCommandsUntilItIsAcknowledged) {
  for (const int level : {0, 1, 2}) {
    Session s;
    ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    s.server.EmergencyStop(level);
    s.Cycle();
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
    EXPECT_EQ(s.server.stop().reason, StopReason::kEmergencyStop);
    EXPECT_EQ(UintAt(s.message, {2, 2}), static_cast<std::uint64_t>(level) + 1);
    EXPECT_EQ(UintAt(s.message, {2, 5}), 0u);
    for (int i = 0; i < 1000; ++i) s.Command(std::vector<double>(7, 0.6));  // a client that did not notice
    EXPECT_EQ(s.server.counters().ignored, 1000u);
    EXPECT_EQ(s.server.q_commanded(), JointVector::Constant(0.5));
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);

    s.server.Acknowledge();
    s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 2}), 0u);
    EXPECT_EQ(UintAt(s.message, {2, 5}), 1u);  // transitioning
    for (int i = 0; i < 498; ++i) s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 5}), 1u);
    s.Cycle();
    EXPECT_EQ(UintAt(s.message, {2, 5}), 2u);
    EXPECT_EQ(s.server.state(), SessionState::kMonitoringReady);
    EXPECT_TRUE(s.WalkTo(SessionState::kCommandingActive));
    EXPECT_EQ(s.server.counters().ignored, 1000u) << "mirrored answers are no commands";
  }
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

using control::CommandMode;
using control::ControlMode;

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

// Its presence is checked while waiting, its value while active.
TEST(FriServer, WrenchOrTorqueMustComeEachTime) {
  for (const bool torque : {false, true}) {
    const FriServerParams params{
        .control_mode = torque ? ControlMode::kJointImpedance : ControlMode::kCartesianImpedance,
        .command_mode = torque ? CommandMode::kTorque : CommandMode::kWrench};
    Session lacking(params);
    ASSERT_TRUE(lacking.WalkTo(SessionState::kCommandingWait));
    for (int i = 0; i < 5; ++i) lacking.Cycle();  // the position alone
    EXPECT_EQ(lacking.server.counters().incomplete, 5u);
    EXPECT_EQ(lacking.server.stop().reason, StopReason::kLostInARow);

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

    Session few(params);
    (torque ? few.client.tau : few.client.wrench) = std::vector<double>(torque ? 7 : 6, 0.0);
    ASSERT_TRUE(few.WalkTo(SessionState::kCommandingActive));
    (torque ? few.client.tau : few.client.wrench).pop_back();
    few.Cycle();
    EXPECT_EQ(few.server.stop().reason, StopReason::kCount);
    EXPECT_EQ(few.server.stop().found, torque ? 6.0 : 5.0);
  }
}

TEST(FriServer, WrenchTorquesMayComeInTheOtherOrder) {
  Session s({.control_mode = ControlMode::kCartesianImpedance,
             .command_mode = CommandMode::kWrench,
             .torques_zyx = false});
  s.client.wrench = {1, 2, 3, 4, 5, 6};
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  s.Cycle();
  EXPECT_EQ(s.server.F_commanded().t, Vector3(4, 5, 6));
}

// "Illegal axis delta": compliant, the arm may be pushed away from what it is told; position control holds.
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

TEST(FriServer, ExternalTorqueIsAnEstimate) {
  FriServerParams params{.external_torque_cutoff_hz = 10.0};
  params.external_torque_offset_Nm[2] = 0.25;
  FriServer server(params, kinematics::Iiwa14().limits, JointVector::Constant(0.5));
  server.Open();
  const JointVector tau = JointVector::Constant(8.0);
  double read_Nm = 0.0;
  for (int i = 0; i < 16; ++i)  // 1 / (2 pi 10 Hz) = 15.9 ms
    read_Nm =
        DoublesAt(server.BeginCycle({.q = JointVector::Constant(0.5), .tau_ext = tau}, 1), {3, 5, 1})[0];
  EXPECT_NEAR(read_Nm, 8.0 * (1.0 - std::exp(-2.0 * 3.14159265358979 * 10.0 * 0.016)), 1e-9);
  const auto bytes = server.BeginCycle({.q = JointVector::Constant(0.5), .tau_meas = tau, .tau_ext = tau}, 1);
  EXPECT_NEAR(DoublesAt(bytes, {3, 5, 1})[2] - DoublesAt(bytes, {3, 5, 1})[0], 0.25, 1e-12);
  EXPECT_EQ(DoublesAt(bytes, {3, 2, 1})[0], 8.0) << "the measured torque is not filtered";
}

TEST(FriServer, CountsGapsInTheClientsOwnCounter) {
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

TEST(FriServer, PeriodsAndMultipliersOfRealArmsReachActive) {
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

TEST(FriServer, RefusesOutputsWithoutSense) {
  const auto make = [](std::vector<ArmIo> ios, std::vector<ArmFrame> frames) {
    FriServer({.ios = std::move(ios), .frames = std::move(frames)}, kinematics::Iiwa14().limits,
              JointVector::Constant(0.5));
  };
  EXPECT_NO_THROW(make({{.name = "a"}, {.name = "b"}}, {{.name = "a"}}));
  EXPECT_THROW(make({{.name = "a"}, {.name = "a"}}, {}), std::invalid_argument);
  EXPECT_THROW(make({{.name = ""}}, {}), std::invalid_argument);
  EXPECT_THROW(make({{.name = std::string(64, 'n')}}, {}), std::invalid_argument);
  EXPECT_THROW(make(std::vector<ArmIo>(11), {}), std::invalid_argument);
  EXPECT_THROW(make({}, std::vector<ArmFrame>(6)), std::invalid_argument);
}

TEST(FriServer, StepJustWithinTheVelocityLimitIsFollowed) {
  Session s;
  ASSERT_TRUE(s.WalkTo(SessionState::kCommandingActive));
  auto q = Start();
  const double step = 75.0 * 3.14159265358979 / 180.0 * 1e-3 * 1.1 - 1e-9;
  q[3] += step;
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
  // two lost ones leave time for three steps
  s.Cycle(false);
  s.Cycle(false);
  q[3] += 3.0 * step;
  s.Command(q);
  EXPECT_EQ(s.server.stop().reason, StopReason::kNone);
  EXPECT_EQ(s.server.q_commanded()[3], q[3]);
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

TEST(FriServer, RefusesParametersWithoutSense) {
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
               std::invalid_argument);  // 50 answers a second are never EXCELLENT
  EXPECT_THROW(FriServer({}, kinematics::Iiwa14().limits, JointVector::Constant(2.2)), std::invalid_argument);
  EXPECT_THROW(FriServer({}, {}, q), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::hil
