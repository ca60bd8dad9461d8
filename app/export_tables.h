#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"

namespace osteon::app {

struct ExportedTables {
  std::uint64_t ticks{0}, frames{0}, events{0};  ///< rows
  std::vector<std::filesystem::path> files;
  bool complete{false};         ///< of the recording; false: it ends early
  std::uint64_t tail_bytes{0};  ///< at its end, of a message that is cut off; or behind its end
  bool closed{false};           ///< its end is there: tail_bytes are behind it
};

/// Writes a recording as tables: `<stem>_ticks.csv`, `<stem>_frames.csv` and `<stem>_events.csv` in `folder`,
/// a message a row. Columns are named once, with their units; `time_s` counts from the session's start.
/// Numbers have the digits that give their bits back. One message at a time is in memory.
/// @param progress  called now and then with the share of the file that is done
/// The error names file, byte and reason (the recording), or the path (a table).
[[nodiscard]] tl::expected<ExportedTables, std::string> ExportTables(
    const std::filesystem::path& recording, const std::filesystem::path& folder, const std::string& stem,
    const std::function<void(double share)>& progress = {});

/// Some ticks of a recording as the same table. @param start  stamp that `time_s` counts from
/// The error names the path.
[[nodiscard]] tl::expected<void, std::string> ExportTicks(std::span<const control::TickRecord> ticks,
                                                          rt::Nanoseconds start,
                                                          const std::filesystem::path& path);

}  // namespace osteon::app
