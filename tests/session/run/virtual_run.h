#pragma once

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/recording/recording_reader.h"
#include "session/run/cell_run.h"
#include "session/setup/cell_setup.h"
#include "session/summary/run_accumulator.h"
#include "session/summary/summary.h"
#include "tests/io/temporary_folder.h"
#include "tests/session/set_up_cell.h"

// Runs of shipped cells in virtual time, for tests.

namespace osteon::session {

/// Collects a recording's ticks and frames for the summary, as the end of a run does.
inline RunAccumulator AccumulateRun(const CellSetup& setup, const io::Recording& recording) {
  RunAccumulator run(setup);
  for (const control::TickRecord& tick : recording.ticks) run.Add(tick);
  for (const simulation::FrameRecord& frame : recording.frames) run.Add(frame);
  return run;
}

/// A run of a shipped cell in virtual time, in this process, with its results.
struct VirtualRun {
  CellRunResult result;
  RunSummary summary;
  io::Recording recording;
  nlohmann::json cell;  ///< osteon.cell/1
};

/// Runs a shipped cell and reads its recording.
/// @param name  name of the cell's file under config/cells, without extension
/// @param change  function of a config::CellConfig&, called before the run to change the cell
/// @param recoveries  how often the run may recover by itself
template <class Change>
VirtualRun RunInVirtualTime(const std::string& name, double seconds, const Change& change,
                            int recoveries = 0) {
  auto setup = SetUpCell(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml", std::nullopt);
  EXPECT_TRUE(setup) << setup.error();
  change(setup->config);
  auto engine = MakeEngine(*setup, {});
  EXPECT_TRUE(engine) << engine.error();
  const io::test::TemporaryFolder folder;
  const CellRunParams params{.seconds = seconds,
                             .virtual_time = true,
                             .recoveries = recoveries,
                             .recording = folder.path() / "r.mcap"};
  auto result = RunCell(*setup, **engine, params);
  EXPECT_TRUE(result) << result.error().what;
  auto recording = io::ReadRecording(params.recording);
  EXPECT_TRUE(recording) << recording.error();
  VirtualRun finished;
  finished.summary = Summarise(*setup, **engine, params, *result, AccumulateRun(*setup, *recording));
  finished.recording = std::move(*recording);
  finished.cell = nlohmann::json::parse(finished.summary.cell_report);
  finished.result = std::move(*result);
  return finished;
}

/// Checks that no commanded joint moves by max_rad or more in a tick while the arm follows the commands.
inline void ExpectNoJump(const io::Recording& recording, double max_rad) {
  const auto active = [](const control::TickRecord& tick) {
    return tick.session_state == static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
  };
  for (std::size_t i = 1; i < recording.ticks.size(); ++i) {
    const control::TickRecord &a = recording.ticks[i - 1], &b = recording.ticks[i];
    if (!active(a) || !active(b)) continue;
    for (std::size_t j = 0; j < 7; ++j)
      ASSERT_LT(std::abs(b.q_cmd[j] - a.q_cmd[j]), max_rad) << "tick " << b.tick << ", joint " << j + 1;
  }
}

}  // namespace osteon::session
