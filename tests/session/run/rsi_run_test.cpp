#include <limits>

#include <gtest/gtest.h>

#include "session/replay/replay.h"
#include "session/setup/recorded_config.h"
#include "tests/session/run/virtual_run.h"

// Runs of the shipped cell with a KR over RSI, in virtual time: its cut, and the effects of a bad connection.

namespace osteon::session {
namespace {

template <class Change>
VirtualRun RunKr(double seconds, const Change& change, int recoveries = 0) {
  return RunInVirtualTime("kr_16_thin_plate", seconds, change, recoveries);
}
void AsShipped(config::CellConfig&) {}

io::RsiSessionParams& Session(config::CellConfig& cell) {
  return std::get<io::RsiSessionParams>(cell.link.session);
}

constexpr double kMaxStep_rad = 4e-3;  // 4 ms at 1 rad/s

TEST(RsiRun, TheShippedCellDrillsThroughItsPlateWithoutAFault) {
  const VirtualRun run = RunKr(10.0, AsShipped);
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_TRUE(run.summary.faults.empty()) << run.summary.faults.front().name;
  EXPECT_EQ(run.summary.servo_rate_hz, 250.0);
  // a hole of 4 mm through 2 mm: 25 mm^3, minus what the drill's point leaves at the far side
  EXPECT_GT(run.summary.removed_volume_m3, 15e-9);
  EXPECT_LT(run.summary.removed_volume_m3, 30e-9);
  EXPECT_GT(run.summary.peak_force_N, 20.0);
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  EXPECT_EQ(run.cell["arm"]["session"], "COMMANDING_ACTIVE");
  EXPECT_EQ(run.cell["arm"]["rsi"], "RSI is answered, the arm follows the corrections");
  EXPECT_EQ(run.cell["arm"]["stop"], "") << "the im_free layout can not ask for the end";
  EXPECT_EQ(run.summary.arm_stop, "");
  EXPECT_EQ(run.cell["arm"]["delay"], 0);
  EXPECT_EQ(run.cell["arm"]["lost"], 0);
  EXPECT_EQ(run.summary.link.lost + run.summary.link.rejected, 0u);
  ExpectNoJump(run.recording, kMaxStep_rad);
  for (const control::TickRecord& tick : run.recording.ticks) ASSERT_EQ(tick.q_cmd[6], 0.0);
}

TEST(RsiRun, EqualRunsGiveEqualStatesAndReplayBitForBit) {
  const VirtualRun a = RunKr(3.0, AsShipped), b = RunKr(3.0, AsShipped);
  EXPECT_EQ(a.summary.state_hash, b.summary.state_hash);
  EXPECT_GT(a.summary.removed_volume_m3, 0.0);
  const auto cell = LoadRecordedCell(a.recording.session.config);
  ASSERT_TRUE(cell) << cell.error();
  const ReplayResult replay = Replay(a.recording, *cell);
  EXPECT_TRUE(replay.identical) << replay.why_not
                                << (replay.first_difference ? replay.first_difference->field : "");
  EXPECT_EQ(replay.ticks, a.recording.ticks.size());
  EXPECT_GT(replay.ticks, 700u);
}

// Absolute joint corrections, Cartesian ones and relative ones give the same hole.
TEST(RsiRun, EveryKindOfCorrectionCutsTheSameVolume) {
  const VirtualRun axes = RunKr(4.0, AsShipped);
  const auto cartesian = [](config::CellConfig& cell) {
    Session(cell).kind = io::RsiCorrection::kCartesian;
    Session(cell).range = cell.simulated.kr->controller.range = {200, 200, 200, 90, 90, 90};
    cell.simulated.kr->controller.cartesian = true;
  };
  const auto relative = [](config::CellConfig& cell) {
    Session(cell).absolute = cell.simulated.kr->controller.absolute = false;
  };
  for (const VirtualRun& other : {RunKr(4.0, cartesian), RunKr(4.0, relative)}) {
    EXPECT_TRUE(other.summary.faults.empty());
    EXPECT_NEAR(other.summary.removed_volume_m3 / axes.summary.removed_volume_m3, 1.0, 0.02);
  }
}

TEST(RsiRun, AsksTheArmsProgramToEndIfTheLayoutHasAStop) {
  const VirtualRun run = RunKr(1.0, [](config::CellConfig& cell) {
    Session(cell).layout = io::RsiLayout::kKroshu;
    cell.simulated.kr->controller.format = hil::RsiFormat::kKroshu;
  });
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_TRUE(run.summary.faults.empty());
  EXPECT_EQ(run.cell["arm"]["session"], "IDLE");
  EXPECT_EQ(run.cell["arm"]["stop"], "asked for by <Stop>1</Stop>");
}

TEST(RsiRun, AnArmThatIsHandedOverElsewhereMovesToTheStart) {
  const VirtualRun run = RunKr(1.0, [](config::CellConfig& cell) {
    cell.simulated.q_start[0] += 0.1;
    cell.simulated.q_start[1] -= 0.05;
  });
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_TRUE(run.summary.faults.empty());
  bool aligning = false;
  for (const control::TickRecord& tick : run.recording.ticks)
    aligning |= tick.phase == control::Phase::kAligning;
  EXPECT_TRUE(aligning);
  ExpectNoJump(run.recording, kMaxStep_rad);
}

// Loses a share of the packets in one direction or both. @param burst  packets per loss
hil::InjectionParams Loss(hil::Direction direction, double loss, double from_s, double to_s, int burst = 1) {
  return {.injections = {{.direction = direction,
                          .from_s = from_s,
                          .to_s = to_s,
                          .faults = {.loss = loss, .burst = burst}}}};
}

// RSI ends after a number of late answers, its Timeout. Below it, a cycle without an answer repeats the last
// correction, and every loss is counted.
TEST(RsiRun, LossesBelowTheTimeoutCauseNoFaultAndAreCountedExactly) {
  const VirtualRun run = RunKr(
      4.0, [](config::CellConfig& cell) { cell.injections = Loss(hil::Direction::kBoth, 0.03, 0.0, 1e9); });
  EXPECT_EQ(run.summary.ended, "completed");
  EXPECT_TRUE(run.summary.faults.empty()) << run.summary.faults.front().name;
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  const unsigned in = run.cell["wires"]["arm_to_controller"]["lost"];
  const unsigned out = run.cell["wires"]["arm_from_controller"]["lost"];
  EXPECT_GT(in, 10u);
  EXPECT_GT(out, 10u);
  EXPECT_EQ(run.summary.link.lost, in);
  EXPECT_EQ(run.cell["arm"]["lost"].get<unsigned>(), in + out);
  EXPECT_EQ(run.cell["arm"]["delay"].get<unsigned>(), in + out);
  EXPECT_LT(in + out, 100u) << "the Timeout";
  ExpectNoJump(run.recording, kMaxStep_rad);
}

// From 1 s on no answer arrives: RSI counts the answers as late up to its Timeout, then ends. The loop stops
// because RSI's messages end.
TEST(RsiRun, BeyondTheTimeoutRsiEndsAndTheLoopStops) {
  const auto lost = [](config::CellConfig& cell) {
    Session(cell).timeout_cycles = cell.simulated.kr->controller.timeout_cycles = 25;
    cell.injections = Loss(hil::Direction::kFromController, 1.0, 1.0, 2.0);
  };
  const VirtualRun run = RunKr(4.0, lost);
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.faults.front().name, "arm message stale");
  EXPECT_EQ(run.cell["arm"]["stop"], "timeout: 25 answers late, RSI ends at 25");
  EXPECT_EQ(run.cell["arm"]["session"], "IDLE");
  EXPECT_EQ(run.recording.ticks.back().phase, control::Phase::kStopped);
  EXPECT_LE(run.summary.peak_force_N, run.summary.force_limit_N);
  ExpectNoJump(run.recording, kMaxStep_rad);

  // a person starts the program again, and the run may recover
  const VirtualRun again = RunKr(
      6.0,
      [&](config::CellConfig& cell) {
        lost(cell);
        cell.simulated.kr->start_again_after_loss = true;
      },
      10);
  EXPECT_EQ(again.summary.ended, "completed");
  EXPECT_TRUE(again.summary.faults.empty());
  EXPECT_EQ(again.summary.recovered, 1);
  std::uint32_t activations = 0;
  for (const control::TickRecord& tick : again.recording.ticks)
    activations = std::max(activations, tick.input.activation);
  EXPECT_EQ(activations, 2u);
  ExpectNoJump(again.recording, kMaxStep_rad);
}

// Sets RSI's option HOLDON to 0: a cycle without an answer then has no correction. From 1 s on, one answer in
// fifty is lost.
void NotHeld(config::CellConfig& cell, double axis_speed_ratio) {
  Session(cell).hold_on = cell.simulated.kr->controller.hold_on = false;
  cell.simulated.kr->controller.axis_speed_ratio = axis_speed_ratio;
  cell.injections = Loss(hil::Direction::kFromController, 0.02, 1.0, 1e9);
}

// With absolute corrections and HOLDON 0, a lost answer has the effect of a correction of zero: the arm jumps
// back toward its pose at RSI's start, whatever the loop commands.
TEST(RsiRun, AnArmThatJumpsByItselfIsStoppedAndItsSpeedIsReported) {
  const VirtualRun run =
      RunKr(8.0, [](config::CellConfig& cell) { NotHeld(cell, std::numeric_limits<double>::infinity()); });
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.ended, "fault");
  EXPECT_EQ(run.summary.faults.front().name, "measured arm speed above limit");
  EXPECT_NE(run.summary.faults.front().seen.find("mm/s"), std::string::npos);
  EXPECT_GT(run.summary.peak_measured_tool_speed_m_per_s, 0.15) << "the cell's limit is 0.1";
  EXPECT_LE(run.summary.peak_tool_speed_m_per_s, 0.1 * 1.1) << "which was kept in what was commanded";
  EXPECT_EQ(run.recording.ticks.back().phase, control::Phase::kStopped);
}

TEST(RsiRun, AControllerThatWatchesItsAxisSpeedsEndsTheSessionWithThisReason) {
  const VirtualRun run = RunKr(8.0, [](config::CellConfig& cell) { NotHeld(cell, 0.2); });
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.ended, "fault");
  EXPECT_NE(run.summary.arm_stop.find("axis speed: A"), std::string::npos) << run.summary.arm_stop;
  EXPECT_NE(run.summary.arm_stop.find("(KSS01102)"), std::string::npos);
}

// The arm's messages are missing for 0.2 s, longer than the loop's arm_miss_count permits.
TEST(RsiRun, StopsIfTheArmsMessagesAreMissing) {
  const VirtualRun run = RunKr(4.0, [](config::CellConfig& cell) {
    cell.injections.injections = {{.direction = hil::Direction::kToController,
                                   .from_s = 1.0,
                                   .to_s = 1.2,
                                   .faults = {.silence = true}}};
  });
  ASSERT_FALSE(run.summary.faults.empty());
  EXPECT_EQ(run.summary.faults.front().name, "arm message stale");
  EXPECT_EQ(run.recording.ticks.back().phase, control::Phase::kStopped);
}

}  // namespace
}  // namespace osteon::session
