#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "session/setup/cell_setup.h"

// A synthetic recording of a long run, and the memory that reading it takes.

namespace osteon::session {

/// Makes a shipped cell with a reamer and without a bone: enough for reading a recording.
[[nodiscard]] CellSetup SetupOfLongRun();

/// Writes ticks and frames at 1 kHz with a clock of their own. The hand wanders, presses and trembles, the
/// durations vary by nanoseconds, every two minutes there is a pause, and some messages are lost. Equal
/// arguments give equal bytes.
void WriteLongRecording(const std::filesystem::path& path, double seconds);

/// Figures of a recording that was read at the end of a run.
struct LongRunEnd {
  std::uint64_t ticks{0}, frames{0};
  std::size_t stops{0};
  double path_tolerance_m{0.0};
};
/// Does what `osteon run` does with a recording at its end, without a bone: reads it once and makes the stop
/// pages, percentiles, charts and the path's sweep. Files go into `folder`.
LongRunEnd EndLongRun(const std::filesystem::path& recording, const std::filesystem::path& folder);

/// Runs `work` in a child process. @returns the child's peak resident memory [bytes]; 0: it failed
[[nodiscard]] std::uint64_t PeakMemory(const std::function<void()>& work);

}  // namespace osteon::session
