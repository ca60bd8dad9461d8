#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "app/cell_setup.h"

// A recording as a long run leaves it, made up; and how much memory reading it takes.

namespace osteon::app {

/// A shipped cell with a reamer, and no bone: all that reading a recording needs of a cell.
[[nodiscard]] CellSetup SetupOfLongRun();

/// Ticks and frames at 1 kHz, by a clock of its own: a hand that wanders, presses and trembles, durations
/// that scatter to the nanosecond, a pause every two minutes, a message that is lost now and then. Equal
/// arguments give equal bytes.
void WriteLongRecording(const std::filesystem::path& path, double seconds);

/// What `osteon run` does at its end with a recording, without a bone: one pass, stop pages, percentiles, the
/// charts of the report, the sweep of the path. Files go into `folder`. @returns the ticks, frames and stops
struct LongRunEnd {
  std::uint64_t ticks{0}, frames{0};
  std::size_t stops{0};
  double path_tolerance_m{0.0};
};
LongRunEnd EndLongRun(const std::filesystem::path& recording, const std::filesystem::path& folder);

/// The most memory that a process of its own has resident while it does this work [bytes]; 0: it failed.
[[nodiscard]] std::uint64_t PeakMemory(const std::function<void()>& work);

}  // namespace osteon::app
