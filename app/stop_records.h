#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"
#include "io/recording/recording_reader.h"
#include "safety/fault.h"

namespace osteon::app {

/// A stop within a recording: the last seconds before it, and what followed. Indices into the ticks.
struct StopRecord {
  std::size_t begin{0};  ///< the first tick of the five seconds before the stop
  std::size_t stop{0};   ///< the first tick in which the loop no longer moved as it was asked to
  std::size_t end{0};    ///< one beyond the last: half a second after the loop was at rest
  safety::FaultSet faults;
  bool asked{false};   ///< for: the run's end, Ctrl-C
  bool paused{false};  ///< by the operator

  /// "arm message stale; motion not permitted", "asked for" or "a pause was asked for".
  [[nodiscard]] std::string Why() const;
};

/// Every stop, in their order: where the loop went from moving (aligning, haptic) to stopping or stopped.
[[nodiscard]] std::vector<StopRecord> FindStops(std::span<const control::TickRecord> ticks);

/// Each stop as a page with its plots and faults, `<stem>_stop_1.html`, and as a table of all its ticks,
/// `<stem>_stop_1_ticks.csv`. Nothing else is touched: run_files.h keeps one run's from another's.
/// @param speed_limit_m_per_s  of the tool
/// @returns the pages; an error names the file.
[[nodiscard]] tl::expected<std::vector<std::filesystem::path>, std::string> WriteStops(
    const io::Recording& recording, double speed_limit_m_per_s, const std::filesystem::path& folder,
    const std::string& stem);

}  // namespace osteon::app
