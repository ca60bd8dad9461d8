// An operator pauses a cell in virtual time and resumes it 1 s later; the run is recorded and replayed.

#include <gtest/gtest.h>

#include <algorithm>

#include "safety/cell_state.h"
#include "session/replay/replay.h"
#include "session/stops/stop_records.h"
#include "tests/session/run/virtual_run.h"
#include "tests/session/set_up_cell.h"

namespace osteon::session {
namespace {

using safety::CellState;

TEST(PauseRun, APausedCellHoldsContinuesWithoutAJumpAndReplaysBitForBit) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/thin_plate.yaml", std::nullopt);
  ASSERT_TRUE(setup) << setup.error();
  auto engine = MakeEngine(*setup, {});
  ASSERT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  base::OperatorRequests pauses;
  double paused_at_s = -1.0;
  bool asked_to_go_on = false;
  const CellRunParams params{.seconds = 4.0,
                             .virtual_time = true,
                             .recording = folder.path() / "r.mcap",
                             .requests = &pauses,
                             .progress = [&](double at_s) {
                               if (at_s >= 3.0 && paused_at_s < 0.0) {
                                 pauses.pause = true;
                                 paused_at_s = at_s;
                               }
                               if (paused_at_s > 0.0 && at_s > paused_at_s + 1.0 && !asked_to_go_on)
                                 asked_to_go_on = pauses.resume = true;
                             }};
  const auto result = RunCell(*setup, **engine, params);
  ASSERT_TRUE(result) << result.error().what;
  ASSERT_TRUE(asked_to_go_on);
  EXPECT_EQ(result->end, control::RunEnd::kSeconds);
  EXPECT_FALSE(result->faults.Any());

  const auto recording = io::ReadRecording(params.recording);
  ASSERT_TRUE(recording) << recording.error();
  const auto is = [](const control::TickRecord& tick, CellState state) {
    return tick.cell_state == static_cast<std::uint8_t>(state);
  };
  std::size_t paused = 0, after = 0;
  const control::TickRecord* before = nullptr;
  for (const control::TickRecord& tick : recording->ticks) {
    if (is(tick, CellState::kPaused)) {
      ++paused;
      if (before && is(*before, CellState::kPaused)) {
        ASSERT_EQ(tick.q_cmd, before->q_cmd) << "held, tick " << tick.tick;
      }
      EXPECT_EQ(tick.spindle_rad_per_s, 0.0);
    }
    after += paused > 0 && safety::Renders(static_cast<CellState>(tick.cell_state)) ? 1u : 0u;
    before = &tick;
  }
  EXPECT_NEAR(static_cast<double>(paused), 1000.0, 200.0) << "ticks of 1 ms between the two askings";
  EXPECT_GT(after, 500u) << "it went on";
  ExpectNoJump(*recording, 2e-3);

  // The run's summary has the pause and the resume as events.
  StopPages pages({.folder = folder.path(), .stem = "r", .cell = setup->config});
  const auto run = ReadRun(params.recording, *setup, pages);
  ASSERT_TRUE(run) << run.error();
  const RunSummary summary = Summarise(*setup, **engine, params, *result, *run);
  ASSERT_EQ(summary.events.size(), 2u);
  EXPECT_EQ(summary.events[0].name, "pause");
  EXPECT_LT(summary.events[0].value, 0.5) << "seconds until it rested";
  EXPECT_EQ(summary.events[1].name, "resume");
  EXPECT_NEAR(summary.events[1].value, 1.0, 0.2) << "seconds paused";
  const nlohmann::json json = nlohmann::json::parse(ToJson(summary, "osteon.run/1"));
  EXPECT_EQ(json["events"][0]["name"], "pause");
  EXPECT_EQ(json["events"][0]["unit"], "s");
  const std::vector<report::SummaryRow> rows = Rows(summary);
  const auto events = std::ranges::find(rows, "Events", &report::SummaryRow::key);
  ASSERT_NE(events, rows.end());
  EXPECT_NE(events->value.find(" s until it rested); resume at "), std::string::npos) << events->value;

  // There are pages of the pause and of the run's end, and none of the PLC's switching of power.
  const auto stops = pages.Finish();
  ASSERT_TRUE(stops) << stops.error();
  ASSERT_EQ(stops->size(), 2u);
  EXPECT_EQ(stops->front().heading, "How the pause began");
  EXPECT_EQ(stops->back().heading, "How the run ended");
  for (const WrittenStop& stop : *stops)
    EXPECT_NE(io::test::ReadAll(stop.page).find("; 0.5 s of that are shown."), std::string::npos)
        << stop.page;
  EXPECT_NE(io::test::ReadAll(stops->back().page).find("How the run ended: 4 s of rendering were over"),
            std::string::npos);
  EXPECT_EQ(summary.arm_stop, "");

  const ReplayResult replayed = Replay(*recording, setup->config);
  EXPECT_TRUE(replayed.identical) << replayed.why_not
                                  << (replayed.first_difference ? replayed.first_difference->field : "");
}

}  // namespace
}  // namespace osteon::session
