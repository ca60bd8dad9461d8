// Tests a whole simulated cell whose wires have injected faults: in virtual time, and in a thread of its own
// over UDP.

#include <vector>

#include <gtest/gtest.h>

#include "hil/impaired_cell.h"
#include "hil/simulated_cell_thread.h"
#include "injection_bench.h"
#include "io/fri/fri_link.h"
#include "io/fri/fri_session.h"
#include "tests/kinematics/iiwa14.h"

namespace osteon::hil {
namespace {

using control::SessionState;

// Parameters of a cell whose session does not end because of lost messages.
SimulatedCellParams PatientCell(int period_ms = 1) {
  SimulatedCellParams params;
  params.arm = kinematics::Iiwa14();
  params.fri.send_period_ms = period_ms;
  params.fri.quality = {.fair_after_answers = 1,
                        .good_after_answers = 2,
                        .excellent_after_answers = 3,
                        .good_max_lost_per_s = 1000000,
                        .end_after_lost_in_a_row = 1000000,
                        .end_after_lost_per_s = 1000000,
                        .good_timeout_s = 3600.0};
  params.q_start = {0.1, 0.6, -0.2, -1.3, 0.3, 0.9, -0.4};
  return params;
}

// The cell of PatientCell, with a reaming script.
SimulatedCell Cell(int period_ms = 1) { return {PatientCell(period_ms), MakeReamingScript({})}; }

// A cell with faults on its wire and an FRI client, in lockstep. One Step() advances the virtual time by one
// millisecond.
struct Lockstep {
  explicit Lockstep(const InjectionParams& injections) : cell(Cell(), injections) {}
  // Runs one period: delivers the messages that arrive in it, and answers the newest of them.
  void Step() {
    now += rt::kMillisecond;
    bool accepted = false;
    arrivals.clear();
    cell.Step(now, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
      bytes.assign(message.begin(), message.end());
      arrivals.push_back(arrival - now);
      accepted |= session.Accept(message, arrival, arm) == io::FriAccept::kAccepted;
    });
    if (accepted) cell.Receive(session.Answer({.q = arm.q_ipo, .activation = arm.activation}));
  }
  // Runs until the cell is commanded. Returns false if that takes longer than 5 s.
  bool StepUntilCommanded() {
    for (int i = 0; i < 5000 && arm.session != SessionState::kCommandingActive; ++i) Step();
    return arm.session == SessionState::kCommandingActive;
  }
  ImpairedCell cell;
  io::FriSession session;
  control::ArmState arm;
  rt::Nanoseconds now{0};
  std::vector<std::uint8_t> bytes;
  std::vector<rt::Nanoseconds>
      arrivals;  // times of arrival, relative to the time at which each message was made
};

TEST(InjectionCell, WithoutInjectionsEveryByteEqualsThePlainCells) {
  Lockstep impaired({});
  SimulatedCell plain = Cell();
  io::FriSession session;
  control::ArmState arm;
  for (rt::Nanoseconds now = rt::kMillisecond; now <= 3 * rt::kSecond; now += rt::kMillisecond) {
    const auto message = plain.Step(now);
    impaired.Step();
    ASSERT_EQ(impaired.bytes, std::vector<std::uint8_t>(message.begin(), message.end()));
    ASSERT_EQ(impaired.arrivals, std::vector<rt::Nanoseconds>{0});
    ASSERT_EQ(Vector3(impaired.cell.cell().force().F_S.f), Vector3(plain.force().F_S.f));
    ASSERT_EQ(session.Accept(message, now, arm), io::FriAccept::kAccepted);
    plain.Receive(session.Answer({.q = arm.q_ipo, .activation = arm.activation}));
  }
  EXPECT_EQ(arm.session, SessionState::kCommandingActive);
  EXPECT_EQ(impaired.cell.state().counters.lost + impaired.cell.state().counters.stale, 0u);
}

// A message and its answer are both delayed. With a delay below half a period, the answer is still in time;
// with a longer delay, every answer is stale.
TEST(InjectionCell, ADelayBelowAPeriodIsExact) {
  for (const rt::Nanoseconds delay : {300'000, 600'000}) {
    Lockstep run({.injections = {{.from_s = 0.0, .to_s = 1.0, .faults = {.delay = delay}}}});
    ASSERT_TRUE(run.StepUntilCommanded());
    for (int i = 0; i < 900; ++i) {
      ASSERT_EQ(run.arrivals, std::vector<rt::Nanoseconds>{delay});
      run.Step();
    }
    // the answer is in time if message and answer both arrive within the period of 1 ms
    const FriCounters& n = run.cell.state().counters;
    if (2 * delay < rt::kMillisecond) {
      EXPECT_EQ(n.lost + n.stale, 0u);
    } else {
      EXPECT_GE(n.stale, 890u);
    }
    EXPECT_EQ(run.arm.lost, 0u);
  }
}

TEST(InjectionCell, InjectionTimesCountFromTheFirstCommanding) {
  Lockstep run({.injections = {{.from_s = 0.05, .to_s = 0.15, .faults = {.silence = true}}}});
  ASSERT_TRUE(run.StepUntilCommanded());
  std::vector<int> missing;
  for (int i = 1; i < 300; ++i) {
    run.Step();
    if (run.arrivals.empty()) missing.push_back(i);
  }
  ASSERT_EQ(missing.size(), 100u);
  EXPECT_EQ(missing.front(), 50);
  EXPECT_EQ(run.cell.counters().arm_to_controller.silenced, 100u);
  EXPECT_EQ(run.arm.lost, 100u);
}

// Compares two runs tick by tick: sequence numbers, and counts of lost and stale messages.
TEST(InjectionCell, TwoRunsOfOneSeedAreTheSame) {
  const auto run = [](std::uint64_t seed) {
    Lockstep r({.injections = {{.faults = {.loss = 0.05,
                                           .burst = 3,
                                           .duplicate = 0.02,
                                           .reorder = 0.05,
                                           .delay = 200'000,
                                           .jitter = 2 * rt::kMillisecond}}},
                .seed = seed});
    EXPECT_TRUE(r.StepUntilCommanded());
    std::vector<std::uint64_t> seen;
    for (int i = 0; i < 1000; ++i) {
      r.Step();
      seen.push_back(r.arm.sequence + 1000 * r.arm.lost + 1'000'000 * r.cell.state().counters.stale);
    }
    return seen;
  };
  EXPECT_EQ(run(3), run(3));
  EXPECT_NE(run(3), run(4));
}

// The period is 100 ms, the delay 5 ms. If datagrams were passed on only at the end of a period, every answer
// would belong to the message before. The times are checked against lower bounds only, because the machine
// may be busy.
TEST(InjectionCellThread, DeliversADelayedMessageWithinItsPeriod) {
  constexpr rt::Nanoseconds kDelay = 5 * rt::kMillisecond;
  auto link = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(link) << link.error();
  SimulatedCellThread cell({.client_port = (*link)->port(), .injections = Always({.delay = kDelay})},
                           Cell(100));
  control::ArmState arm;
  constexpr std::uint64_t kMessages = 8;
  for (std::uint64_t k = 0; k < kMessages; ++k) {
    ASSERT_EQ((*link)->Receive(arm, rt::MonotonicNow() + 5 * rt::kSecond), control::ReceiveResult::kOk);
    const io::FriTime made = (*link)->session().message().time.value();
    EXPECT_GE(arm.stamp, made.sec * rt::kSecond + made.nanosec + kDelay);
    ASSERT_TRUE((*link)->Send({.q = arm.q_ipo}));
  }
  while (cell.statistics().wires.arm_from_controller.passed < kMessages)
    rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
  cell.Stop();
  const CellThreadStatistics& s = cell.statistics();
  EXPECT_GT(s.cell.counters.answered, 0u) << "there and back within a period";
  EXPECT_EQ(s.wires.arm_to_controller.delayed, s.wires.arm_to_controller.pushed);
  EXPECT_EQ(arm.lost, 0u);
}

TEST(InjectionCellThread, CellAndClientCountTheSameFaults) {
  auto link = io::FriLink::Open({.port = 0});
  ASSERT_TRUE(link) << link.error();
  const InjectionParams params{
      .injections = {
          {.direction = Direction::kToController, .from_s = -1, .faults = {.loss = 0.2, .duplicate = 0.1}}}};
  SimulatedCellThread cell({.client_port = (*link)->port(), .injections = params}, Cell(5));
  control::ArmState arm;
  for (int k = 0; k < 200; ++k)
    ASSERT_EQ((*link)->Receive(arm, rt::MonotonicNow() + 5 * rt::kSecond), control::ReceiveResult::kOk);
  cell.Stop();
  while ((*link)->Receive(arm, rt::MonotonicNow()) == control::ReceiveResult::kOk) {
  }
  const CellThreadStatistics& s = cell.statistics();
  const WireCounters& n = s.wires.arm_to_controller;
  EXPECT_GT(n.lost, 10u);
  EXPECT_GT(n.duplicated, 5u);
  EXPECT_EQ(n.passed, n.pushed - n.lost + n.duplicated);
  EXPECT_EQ(arm.duplicate, n.duplicated);
  // losses before the first answer received, or after the last one, leave no gap in the sequence
  EXPECT_LE(arm.lost, n.lost);
}

}  // namespace
}  // namespace osteon::hil
