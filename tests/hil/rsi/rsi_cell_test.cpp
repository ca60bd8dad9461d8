// Tests a simulated cell whose arm is a KR robot that speaks RSI, in lockstep with the product's RSI session:
// the hand, the drives' power, restarts, and faults on the wire.

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "hil/impaired_cell.h"
#include "hil/operator/scripts.h"
#include "hil/simulated_cell.h"
#include "io/rsi/rsi_session.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::hil {
namespace {

using control::SessionState;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr rt::Nanoseconds kCycle = 4 * rt::kMillisecond;  // cycle time of RSI

// A KR 16 whose tool and base have general poses. RSI ends after 20 late answers.
SimulatedCellParams Params() {
  SimulatedCellParams params;
  RsiArmParams& kr = params.kr.emplace();
  kr.controller.arm = kinematics::Kr16Params();
  kr.controller.timeout_cycles = 20;
  Pose X_FT = Pose::Identity();
  X_FT.translation() = Vector3(0.02, -0.01, 0.18);
  params.X_FT = X_FT;
  Pose X_WB = Pose::Identity();
  X_WB.linear() = Eigen::AngleAxisd(0.8, Vector3::UnitZ()).toRotationMatrix();
  params.X_WB = X_WB;
  params.q_start = {0.1, -1.5, 1.6, 0.2, 1.2, 0.3, 0.0};
  return params;
}

// Parameters of an RSI session that fit the cell's controller.
io::RsiSessionParams SessionParams(const SimulatedCellParams& params) {
  return {.timeout_cycles = params.kr->controller.timeout_cycles, .arm = params.kr->controller.arm};
}

// Pose of the tool in W at the start, computed by the closed-form kinematics.
Pose StartPose(const SimulatedCellParams& params) {
  const kinematics::OrthoParallelArm arm(params.kr->controller.arm);
  const kinematics::JointVectorN<6> q(params.q_start.data());
  return Pose(params.X_WB) * arm.FlangePose(q) * Pose(params.X_FT);
}

// A reaming script in a cup directly below the tool's start pose.
HandScript Script(const SimulatedCellParams& params) {
  Pose X_WC = StartPose(params) * Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX());
  X_WC.translation() = StartPose(params) * Vector3(0.0, 0.0, 0.040 - 0.025);
  return MakeReamingScript({.X_WC = X_WC, .seconds = 4});
}

// Replaces the control loop. Once the session is active, it commands all axes along a slow cosine that begins
// at the pose at which the session became active.
class Client {
 public:
  explicit Client(const io::RsiSessionParams& params) : session(params) {}

  void Accept(std::span<const std::uint8_t> message, rt::Nanoseconds now) {
    accepted = session.Accept(message, now, arm) == io::RsiAccept::kAccepted;
  }
  std::span<const std::uint8_t> Answer() {
    control::ArmCommand command;
    command.activation = arm.activation;
    if (arm.session != SessionState::kCommandingActive) since_ = arm.stamp;
    const double t_s = rt::ToSeconds(arm.stamp - since_);
    for (std::size_t i = 0; i < 6; ++i)
      command.q[i] = arm.q_ipo[i] + 2.0 * kDegree * (1.0 - std::cos(0.5 * t_s));
    return session.Answer(command);
  }

  io::RsiSession session;
  control::ArmState arm;
  bool accepted{false};

 private:
  rt::Nanoseconds since_{0};
};

struct Outcome {
  std::vector<std::uint8_t> bytes;  // all messages that the cell has sent
  CellState end;
};

// Runs cell and client for this number of cycles without faults.
Outcome RunCell(const SimulatedCellParams& params, int cycles) {
  SimulatedCell cell(params, Script(params));
  Client client(SessionParams(params));
  Outcome run;
  for (int k = 1; k <= cycles; ++k) {
    const auto message = cell.Step(k * kCycle);
    run.bytes.insert(run.bytes.end(), message.begin(), message.end());
    client.Accept(message, k * kCycle);
    EXPECT_TRUE(cell.Receive(client.Answer()));
  }
  run.end = cell.state();
  return run;
}

TEST(RsiCell, TwoRunsGiveTheSameBytes) {
  const Outcome a = RunCell(Params(), 500), b = RunCell(Params(), 500);
  ASSERT_GT(a.bytes.size(), 500u * 300u);
  EXPECT_EQ(a.bytes, b.bytes);
  EXPECT_EQ(a.end.q_meas, b.end.q_meas);
}

TEST(RsiCell, TheHandHoldsTheToolAtTheMeasuredPose) {
  const SimulatedCellParams params = Params();
  const Outcome run = RunCell(params, 500);
  EXPECT_EQ(run.end.session, SessionState::kCommandingActive) << DescribeStop(run.end);
  EXPECT_GT(run.end.cell_time_s, 1.9) << "since it was handed over";
  EXPECT_GT(Vector3(run.end.F_hand_T_W.f).norm(), 1.0);
  const kinematics::OrthoParallelArm arm(params.kr->controller.arm);
  const kinematics::JointVectorN<6> q(run.end.q_meas.data());
  const Pose X_WT = Pose(params.X_WB) * arm.FlangePose(q) * Pose(params.X_FT);
  EXPECT_LT((Pose(run.end.X_WT_meas).matrix() - X_WT.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(run.end.q_meas[6], 0.0);
  EXPECT_EQ(run.end.counters.answered, run.end.counters.sent - 1) << "the last is not judged yet";
}

// Compares the tool's velocity with the difference of its poses, at both levels of the arm's simulation.
TEST(RsiCell, ToolVelocityIsTheDerivativeOfItsPose) {
  for (const ArmLevel level : {ArmLevel::kKinematic, ArmLevel::kServo}) {
    SimulatedCellParams params = Params();
    params.kr->controller.level = level;
    SimulatedCell cell(params, Script(params));
    Client client(SessionParams(params));
    std::vector<CellState> states;
    for (int k = 1; k <= 300; ++k) {
      client.Accept(cell.Step(k * kCycle), k * kCycle);
      cell.Receive(client.Answer());
      states.push_back(cell.state());
    }
    const Vector3 before = states[297].X_WT_meas.p, after = states[299].X_WT_meas.p;
    const Vector3 v = states[298].v_WT_meas_m_per_s, difference = (after - before) / 0.008;
    EXPECT_GT(v.norm(), 0.01);
    // at the kinematic level the velocity is a backward difference, which is half a cycle older; the
    // acceleration is below 0.1 m/s^2
    EXPECT_LT((v - difference).norm(), 0.1 * 0.004) << static_cast<int>(level);
  }
}

// The PLC switches the power of the drives on, off and on again.
TEST(RsiCell, RsiEndsWithoutPowerAndBeginsAnewWithIt) {
  const SimulatedCellParams params = Params();
  SimulatedCell cell(params, Script(params));
  Client client(SessionParams(params));
  cell.SetPower(false);  // the PLC has not yet switched the power on
  EXPECT_TRUE(cell.Step(kCycle).empty());
  EXPECT_EQ(cell.state().session, SessionState::kIdle);
  EXPECT_EQ(DescribeStop(cell.state()), "the drives have no power");
  rt::Nanoseconds now = kCycle;
  const auto cycles = [&](int count) {
    for (int k = 0; k < count; ++k) {
      now += kCycle;
      client.Accept(cell.Step(now), now);
      if (client.accepted) cell.Receive(client.Answer());
    }
  };
  cell.SetPower(true);
  cycles(300);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingActive);
  EXPECT_EQ(DescribeStop(cell.state()), "");
  cell.SetPower(false);
  const auto q = cell.state().q_cmd;
  cycles(200);
  EXPECT_EQ(cell.state().session, SessionState::kIdle);
  EXPECT_EQ(cell.state().q_cmd, q);
  cell.SetPower(true);
  cycles(5);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingWait);
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(client.arm.q_ipo[i], q[i], 1e-5) << "begins where it stands";
  cycles(100);
  EXPECT_EQ(client.session.status().sessions, 2u);
  EXPECT_EQ(client.arm.activation, 2u);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingActive);
  EXPECT_EQ(cell.state().counters.sent, 300u + 105u) << "counts go on";
}

// If nobody answers, RSI ends after 20 cycles, and the robot's program starts it again 1 s later. So a PC
// that connects late can command the arm as usual.
TEST(RsiCell, WaitsForAPcThatComesLate) {
  const SimulatedCellParams params = Params();
  SimulatedCell cell(params, Script(params));
  rt::Nanoseconds now = 0;
  int messages = 0;
  for (int k = 0; k < 1000; ++k) messages += cell.Step(now += kCycle).empty() ? 0 : 1;
  EXPECT_NEAR(messages, 1000 * 20 / (20 + 250), 20) << "20 cycles of 4 ms, then a second without";
  EXPECT_EQ(DescribeStop(cell.state()),
            cell.state().session == SessionState::kIdle ? "timeout: 20 answers late, RSI ends at 20" : "");
  Client client(SessionParams(params));
  for (int k = 0; k < 600; ++k) {
    now += kCycle;
    client.Accept(cell.Step(now), now);
    if (client.accepted) cell.Receive(client.Answer());
  }
  EXPECT_EQ(client.arm.session, SessionState::kCommandingActive);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingActive);
}

TEST(RsiCell, BeginsAgainAfterALossOnlyIfConfigured) {
  for (const bool again : {false, true}) {
    SimulatedCellParams params = Params();
    params.kr->start_again_after_loss = again;
    SimulatedCell cell(params, Script(params));
    Client client(SessionParams(params));
    rt::Nanoseconds now = 0;
    for (int k = 0; k < 100; ++k) {
      now += kCycle;
      client.Accept(cell.Step(now), now);
      cell.Receive(client.Answer());
    }
    for (int k = 0; k < 200; ++k) cell.Step(now += kCycle);  // the PC does not answer for 0.8 s
    EXPECT_EQ(cell.state().rsi_stop.reason, RsiStopReason::kTimeout);
    EXPECT_EQ(cell.state().delay, 20u);
    for (int k = 0; k < 200; ++k) {
      now += kCycle;
      client.Accept(cell.Step(now), now);
      if (client.accepted) cell.Receive(client.Answer());
    }
    EXPECT_EQ(cell.state().session, again ? SessionState::kCommandingActive : SessionState::kIdle);
    EXPECT_EQ(DescribeStop(cell.state()), "timeout: 20 answers late, RSI ends at 20")
        << "the last one is kept";
  }
}

// Step(now, false) means that the cell itself was late. The unanswered cycles must raise the counter Delay,
// because Delay tells the PC that its answers had no effect. They must not end RSI.
TEST(RsiCell, LatenessOfTheCellItselfDoesNotEndRsi) {
  const SimulatedCellParams params = Params();
  SimulatedCell cell(params, Script(params));
  Client client(SessionParams(params));
  rt::Nanoseconds now = 0;
  for (int k = 0; k < 50; ++k) {
    now += kCycle;
    client.Accept(cell.Step(now), now);
    cell.Receive(client.Answer());
  }
  for (int k = 0; k < 30; ++k) ASSERT_FALSE(cell.Step(now += kCycle, false).empty());
  EXPECT_EQ(cell.state().counters.excused, 29u) << "the first is the last answer's";
  EXPECT_EQ(cell.state().counters.lost, 0u);
  EXPECT_EQ(cell.state().delay, 29u);
}

// Each lost message and each lost answer must cost exactly one cycle. The counter Delay must count both.
TEST(RsiCell, ClientAndCellCountTheLossesOnTheWire) {
  SimulatedCellParams params = Params();
  params.kr->controller.timeout_cycles = 1000;
  InjectionParams injections;
  injections.injections = {{.from_s = 0.2, .to_s = 3.0, .faults = {.loss = 0.05}}};
  ImpairedCell cell(SimulatedCell(params, Script(params)), injections);
  Client client(SessionParams(params));
  for (int k = 1; k <= 1000; ++k) {
    client.accepted = false;
    cell.Step(k * kCycle, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
      client.Accept(message, arrival);
    });
    if (client.accepted) cell.Receive(client.Answer());
  }
  const CellWireCounters n = cell.counters();
  EXPECT_GT(n.arm_to_controller.lost, 10u);
  EXPECT_GT(n.arm_from_controller.lost, 10u);
  EXPECT_EQ(client.arm.lost, n.arm_to_controller.lost);
  EXPECT_EQ(cell.state().counters.lost, n.arm_to_controller.lost + n.arm_from_controller.lost);
  EXPECT_EQ(cell.state().delay, cell.state().counters.lost);
  EXPECT_EQ(cell.state().session, SessionState::kCommandingActive);
}

TEST(RsiCell, RefusesParametersThatRsiDoesNotSupport) {
  SimulatedCellParams params = Params();
  params.kr->controller.level = ArmLevel::kDynamic;
  EXPECT_THROW(SimulatedCell(params, Script(Params())), std::invalid_argument);
  params = Params();
  params.kr->start_again_s = -1.0;
  EXPECT_THROW(SimulatedCell(params, Script(Params())), std::invalid_argument);
  params = Params();
  SimulatedCell cell(params, Script(params));
  EXPECT_THROW(static_cast<void>(cell.server()), std::bad_cast) << "it speaks no FRI";
}

}  // namespace
}  // namespace osteon::hil
