// A cell in virtual time that a fault holds, until an operator recovers it or the run is stopped. Both runs
// are recorded and replayed.

#include <gtest/gtest.h>

#include "safety/cell_state.h"
#include "session/replay/replay.h"
#include "tests/session/run/virtual_run.h"
#include "tests/session/set_up_cell.h"

namespace osteon::session {
namespace {

using safety::CellState;

// Messages and answers are lost for 60 ms: the loop stops, and the arm ends the session and asks for a new
// one.
config::CellConfig WithASilentArm(config::CellConfig cell) {
  cell.simulated.fri.request_again_after_loss = true;
  cell.injections.injections = {{.from_s = 2.0, .to_s = 2.06, .faults = {.silence = true}}};
  return cell;
}

std::size_t CountTicks(const io::Recording& recording, CellState state) {
  return static_cast<std::size_t>(std::ranges::count(recording.ticks, static_cast<std::uint8_t>(state),
                                                     &control::TickRecord::cell_state));
}

class HeldFault : public testing::Test {
 protected:
  // Runs thin_plate for 4 s of rendering. @param recover_after_s, stop_after_s  time from the fault to the
  // operator's request to recover or to end the run; negative: never
  void RunWithSilentArm(double recover_after_s, double stop_after_s = -1.0) {
    setup_ = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
    ASSERT_TRUE(setup_) << setup_.error();
    setup_->config = WithASilentArm(setup_->config);
    auto engine = MakeEngine(*setup_, {});
    ASSERT_TRUE(engine) << engine.error();
    base::OperatorRequests requests;
    std::atomic<bool> stop{false};
    // whether delay_s have passed since the first tick with a fault, whose stamp is kept in `since`
    const auto after = [&](const control::TickRecord& tick, double delay_s, rt::Nanoseconds& since) {
      if (since < 0 && tick.faults != 0) since = tick.stamp;
      return since >= 0 && delay_s >= 0.0 && rt::ToSeconds(tick.stamp - since) >= delay_s;
    };
    rt::Nanoseconds since = -1;
    bool asked = false;
    const CellRunParams params{
        .seconds = 4.0,
        .virtual_time = true,
        .hold_at_fault = true,
        .recording = folder_.path() / "r.mcap",
        .stop = &stop,
        .requests = &requests,
        .ticked = [&](const control::TickRecord& tick, const simulation::ContactModel&) {
          if (!asked && after(tick, recover_after_s, since)) asked = requests.recover = true;
          if (after(tick, stop_after_s, since)) stop.store(true);
        }};
    auto result = RunCell(*setup_, **engine, params);
    ASSERT_TRUE(result) << result.error().what;
    auto recording = io::ReadRecording(params.recording);
    ASSERT_TRUE(recording) << recording.error();
    recording_ = std::move(*recording);
    summary_ = Summarise(*setup_, **engine, params, *result, AccumulateRun(*setup_, recording_));
    result_ = std::move(*result);
  }

  void ExpectReplaysBitForBit() const {
    const ReplayResult replayed = Replay(recording_, setup_->config);
    EXPECT_TRUE(replayed.identical) << replayed.why_not
                                    << (replayed.first_difference ? replayed.first_difference->field : "");
  }

  const io::test::TemporaryFolder folder_;
  decltype(SetUpCell("", std::nullopt)) setup_;
  CellRunResult result_;
  io::Recording recording_;
  RunSummary summary_;
};

TEST_F(HeldFault, ARecoveryContinuesWithoutAJumpButTheRunsVerdictStaysBad) {
  ASSERT_NO_FATAL_FAILURE(RunWithSilentArm(1.0));
  EXPECT_EQ(result_.end, control::RunEnd::kSeconds);
  EXPECT_EQ(result_.operator_recoveries, 1);
  EXPECT_FALSE(result_.faults.Any());
  EXPECT_TRUE(result_.cleared.Any());
  EXPECT_GT(CountTicks(recording_, CellState::kFault), 500u) << "held, though the arm had come back";
  EXPECT_GT(CountTicks(recording_, CellState::kRecovery), 0u) << "through the state machine";
  ExpectNoJump(recording_, 2e-3);

  EXPECT_EQ(summary_.verdict.level, VerdictLevel::kBad);
  EXPECT_EQ(ExitCode(result_), 1);
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary_, "osteon.run/1"));
  EXPECT_EQ(json["operator_recoveries"], 1);
  EXPECT_EQ(json["recovered"], 1);
  EXPECT_FALSE(json["recovered_from"].empty());
  ExpectReplaysBitForBit();
}

TEST_F(HeldFault, AStopDuringTheHoldEndsTheRunWithTheFault) {
  ASSERT_NO_FATAL_FAILURE(RunWithSilentArm(-1.0, 1.0));
  EXPECT_EQ(result_.end, control::RunEnd::kFault);
  EXPECT_EQ(result_.operator_recoveries, 0);
  EXPECT_TRUE(result_.faults.Any());
  EXPECT_GT(CountTicks(recording_, CellState::kFault), 500u);
  EXPECT_EQ(CountTicks(recording_, CellState::kRecovery), 0u);
  EXPECT_EQ(summary_.verdict.level, VerdictLevel::kBad);
  ExpectReplaysBitForBit();
}

}  // namespace
}  // namespace osteon::session
