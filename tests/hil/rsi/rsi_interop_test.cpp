// Tests RSI between the simulated KR and the product's session. Each side has its own reader and writer of
// the protocol. Both must agree, in lockstep and over UDP.

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "hil/operator/scripts.h"
#include "hil/rsi/rsi_controller.h"
#include "hil/simulated_cell_thread.h"
#include "io/rsi/rsi_link.h"
#include "tests/kinematics/kr_arms.h"

namespace osteon::hil {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// Parameters of the simulated controller, and of a session that fits it.
struct BothSides {
  RsiControllerParams controller;
  io::RsiSessionParams session;
};

BothSides MakeBothSides(bool kroshu, bool cartesian, bool absolute, bool hold_on, int cycle_ms,
                        int ipoc_step) {
  BothSides setup;
  setup.controller.arm = kinematics::Kr6R900Params();
  setup.controller.format = kroshu ? RsiFormat::kKroshu : RsiFormat::kImFree;
  setup.controller.cartesian = cartesian;
  setup.controller.absolute = absolute;
  setup.controller.hold_on = hold_on;
  setup.controller.cycle_ms = cycle_ms;
  setup.controller.ipoc_step = ipoc_step;
  setup.controller.timeout_cycles = 1'000'000;
  setup.controller.range = {900, 900, 900, 90, 90, 90};
  // no speed limit of the axes, because the tests contain steps and jumps
  setup.controller.axis_speed_ratio = std::numeric_limits<double>::infinity();
  setup.session = {.layout = kroshu ? io::RsiLayout::kKroshu : io::RsiLayout::kImFree,
                   .kind = cartesian ? io::RsiCorrection::kCartesian : io::RsiCorrection::kAxes,
                   .absolute = absolute,
                   .hold_on = hold_on,
                   .cycle_ms = cycle_ms,
                   .ipoc_step = ipoc_step,
                   .entry_step_deg = 180.0,
                   .range = {900, 900, 900, 90, 90, 90},
                   .arm = setup.controller.arm};
  return setup;
}

// The joint command at the time t_s [s]. Each axis moves along a slow sine of 4 deg that begins at the start
// position.
control::ArmCommand SineCommand(const Six& start_deg, double t_s, std::uint32_t activation) {
  control::ArmCommand command;
  command.activation = activation;
  for (std::size_t i = 0; i < 6; ++i)
    command.q[i] = (start_deg[i] + 4.0 * std::sin(1.5 * t_s + 0.3 * static_cast<double>(i)) -
                    4.0 * std::sin(0.3 * static_cast<double>(i))) *
                   kDegree;
  return command;
}

TEST(RsiInterop, ArmFollowsTheCommandInEveryMode) {
  for (const bool kroshu : {false, true})
    for (const bool cartesian : {false, true})
      for (const bool absolute : {false, true})
        for (const int cycle_ms : {4, 12})
          for (const int step : {1, cycle_ms}) {
            SCOPED_TRACE(testing::Message()
                         << "kroshu " << kroshu << " cartesian " << cartesian << " absolute " << absolute
                         << " cycle " << cycle_ms << " step " << step);
            const BothSides setup = MakeBothSides(kroshu, cartesian, absolute, true, cycle_ms, step);
            RsiController controller(setup.controller);
            io::RsiSession session(setup.session);
            control::ArmState arm;
            control::ArmCommand command;
            for (int k = 0; k < 300; ++k) {
              const rt::Nanoseconds now = (1 + k) * rt::kMillisecond * cycle_ms;
              const auto message = controller.Step();
              if (k > 11) {  // the controller now uses the previous answer
                for (std::size_t i = 0; i < 6; ++i)
                  ASSERT_NEAR(controller.state().axes_set_deg[i], command.q[i] / kDegree, 2e-3) << k;
              }
              ASSERT_EQ(session.Accept(message, now, arm), io::RsiAccept::kAccepted)
                  << io::Describe(session.last_error());
              ASSERT_NEAR(arm.q_meas[2], controller.state().axes_measured_deg[2] * kDegree, 1e-6);
              command =
                  SineCommand(setup.controller.start_deg, k < 10 ? 0.0 : 0.004 * (k - 10), arm.activation);
              ASSERT_TRUE(controller.Receive(session.Answer(command))) << controller.last_error();
            }
            EXPECT_EQ(arm.session, control::SessionState::kCommandingActive);
            EXPECT_EQ(arm.period_s, 1e-3 * cycle_ms);
            EXPECT_EQ(arm.lost + arm.duplicate + arm.late + arm.rejected, 0u);
            EXPECT_EQ(controller.state().counters.missed, 0u);
          }
}

// Relative corrections are summed on both sides. A tenth of the messages are lost and a tenth of the answers
// are late. The session's sum must equal the controller's in every cycle; otherwise the arm would drift.
TEST(RsiInterop, SumsOfRelativeCorrectionsAgreeDespiteLosses) {
  for (const bool hold_on : {false, true})
    for (const bool in_a_row : {false, true}) {
      constexpr unsigned kSeed = 5;
      SCOPED_TRACE(testing::Message()
                   << "seed " << kSeed << " hold_on " << hold_on << " in a row " << in_a_row);
      std::mt19937 random(kSeed);
      BothSides setup = MakeBothSides(false, false, false, hold_on, 4, 4);
      setup.controller.delay_in_a_row = in_a_row;
      RsiController controller(setup.controller);
      io::RsiSession session(setup.session);
      control::ArmState arm;
      std::vector<std::uint8_t> late;
      int losses = 0;
      for (int k = 0; k < 5000; ++k) {
        const auto message = controller.Step();
        const bool lost = k > 20 && random() % 10 == 0, delayed = k > 20 && random() % 10 == 0;
        if (!late.empty()) controller.Receive(late);  // arrives after its cycle
        late.clear();
        losses += lost || delayed ? 1 : 0;
        if (lost) continue;
        ASSERT_EQ(session.Accept(message, (1 + k) * 4 * rt::kMillisecond, arm), io::RsiAccept::kAccepted);
        for (std::size_t i = 0; i < 6; ++i)
          ASSERT_NEAR(session.status().sum[i], controller.state().correction[i], 1e-6) << "cycle " << k;
        const auto answer = session.Answer(
            SineCommand(setup.controller.start_deg, k < 10 ? 0.0 : 0.004 * (k - 10), arm.activation));
        if (delayed)
          late.assign(answer.begin(), answer.end());
        else
          ASSERT_TRUE(controller.Receive(answer));
      }
      EXPECT_GT(losses, 500);
      EXPECT_TRUE(controller.state().running) << Describe(controller.state().stop);
      EXPECT_GT(controller.state().counters.late, 100u);
    }
}

// RSI ends because the PC does not answer, and is started again. The arm is then at 8 deg and must stay
// within 0.1 deg of its command.
TEST(RsiInterop, AfterTimeoutAndRestartTheArmDoesNotJump) {
  BothSides setup = MakeBothSides(true, false, true, true, 4, 4);
  setup.controller.timeout_cycles = 5;
  RsiController controller(setup.controller);
  io::RsiSession session(setup.session);
  control::ArmState arm;
  rt::Nanoseconds now = 0;
  const auto cycle = [&](const Six& offset_deg) {
    const auto message = controller.Step();
    ASSERT_EQ(session.Accept(message, now += 4 * rt::kMillisecond, arm), io::RsiAccept::kAccepted);
    control::ArmCommand command;
    command.q = arm.q_ipo;
    command.activation = arm.activation;
    for (std::size_t i = 0; i < 6; ++i) command.q[i] += offset_deg[i] * kDegree;
    ASSERT_TRUE(controller.Receive(session.Answer(command))) << controller.last_error();
  };
  for (int k = 0; k < 100; ++k) cycle({8, 0, 0, 0, 0, 0});
  while (!controller.Step().empty()) now += 4 * rt::kMillisecond;  // the PC does not answer until RSI ends
  ASSERT_EQ(controller.state().stop.reason, RsiStopReason::kTimeout);
  for (int k = 0; k < 300; ++k) controller.Step();  // until the arm is at rest
  now += 2 * rt::kSecond;

  controller.Restart();
  for (int k = 0; k < 100; ++k) {
    cycle({0.01 * k, 0, 0, 0, 0, 0});
    EXPECT_NEAR(controller.state().axes_set_deg[0], 8.0 + 0.01 * std::max(0, k - 1), 0.1) << k;
  }
  EXPECT_EQ(session.status().sessions, 2u);
  session.RequestStop();
  cycle({0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(controller.Step().empty());
  EXPECT_EQ(controller.state().stop.reason, RsiStopReason::kAskedFor);
}

TEST(RsiInterop, LinkMovesTheArmOverUdp) {
  const BothSides setup = MakeBothSides(true, false, true, true, 4, 4);
  auto link = io::RsiLink::Open({.port = 0, .session = setup.session});
  ASSERT_TRUE(link) << link.error();
  SimulatedCellParams params;
  params.kr = RsiArmParams{.controller = setup.controller};
  for (std::size_t i = 0; i < 6; ++i) params.q_start[i] = setup.controller.start_deg[i] * kDegree;
  // the script's place is far away, so the hand does not touch the tool
  SimulatedCellThread cell({.client_port = (*link)->port()},
                           SimulatedCell(params, MakeReamingScript({.X_WC = Pose::Identity()})));
  control::ArmState arm;
  control::ArmCommand command;
  for (int k = 0; k < 20'000 && std::abs(arm.q_meas[0]) < 4.5 * kDegree; ++k) {
    const auto result = (*link)->Receive(arm, rt::MonotonicNow() + 2 * rt::kSecond);
    ASSERT_EQ(result, control::ReceiveResult::kOk);
    command.q = arm.q_ipo;
    command.q[0] += 5.0 * kDegree;
    command.activation = arm.activation;
    ASSERT_TRUE((*link)->Send(command));
  }
  EXPECT_EQ(arm.session, control::SessionState::kCommandingActive);
  EXPECT_GT(arm.q_meas[0], 4.4 * kDegree);
  cell.Stop();
  const CellState& state = cell.statistics().cell;
  EXPECT_EQ(state.counters.malformed, 0u);
  EXPECT_EQ(state.session, control::SessionState::kCommandingActive) << DescribeStop(state);
  EXPECT_EQ(arm.rejected, 0u);
}

}  // namespace
}  // namespace osteon::hil
