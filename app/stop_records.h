#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/cell_config.h"
#include "control/tick_record.h"
#include "io/recording/recording_reader.h"
#include "safety/fault.h"

namespace osteon::app {

/// A stop within a recording: the last seconds before it, and what followed. Indices into the ticks.
struct StopRecord {
  std::size_t begin{0};  ///< the first tick of the five seconds before the stop
  std::size_t stop{0};   ///< the first tick in which the loop no longer moved as it was asked to
  std::size_t rest{0};   ///< the first tick at rest; beyond the last where there is none
  std::size_t end{0};    ///< one beyond the last: half a second at rest, as far as it was recorded
  safety::FaultSet faults;
  bool asked{false};   ///< for: the run's end, Ctrl-C
  bool paused{false};  ///< by the operator

  [[nodiscard]] bool IsPause() const { return paused && !asked && !faults.Any(); }
  /// "arm message stale; motion not permitted", "asked for" or "a pause was asked for".
  [[nodiscard]] std::string Why() const;
  /// "What led to the stop", or of a stop without a fault "How the run ended" or "How the pause began".
  [[nodiscard]] const char* Heading() const;
};

/// What the recording's event of a run's orderly end begins with; why it ended follows.
inline constexpr const char* kEndEvent = "end: ";
/// From that event: "4 s of rendering were over"; a text of its own where there is none.
[[nodiscard]] std::string EndReason(std::span<const io::RecordedEvent> events);

/// Every stop, in their order: where the loop went from moving (aligning, haptic) to stopping, stopped or
/// paused.
[[nodiscard]] std::vector<StopRecord> FindStops(std::span<const control::TickRecord> ticks);

/// A stop's page, and what it is called beside its path.
struct WrittenStop {
  std::filesystem::path page;
  std::string heading;  ///< StopRecord::Heading
};

/// Each stop as a page with its plots and faults, `<stem>_stop_1.html`, and as a table of all its ticks,
/// `<stem>_stop_1_ticks.csv`. Nothing else is touched: run_files.h keeps one run's from another's.
/// @param cell  that was run: its limits are drawn
/// @returns the pages; an error names the file.
[[nodiscard]] tl::expected<std::vector<WrittenStop>, std::string> WriteStops(
    const io::Recording& recording, const config::CellConfig& cell, const std::filesystem::path& folder,
    const std::string& stem);

}  // namespace osteon::app
