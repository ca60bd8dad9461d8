#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/tick_record.h"

namespace osteon::session {

/// The result of an export as tables.
struct ExportedTables {
  std::uint64_t ticks{0}, frames{0}, events{0};  ///< number of rows in each table
  std::vector<std::filesystem::path> files;
  bool complete{false};         ///< the recording is complete; false: it ends early
  std::uint64_t tail_bytes{0};  ///< bytes of a cut-off message at the end, or after the recording's end
  bool closed{false};           ///< the recording's end is present, and tail_bytes follow it
};

/// Writes a recording as tables, one message a row: `<stem>_ticks.csv`, `<stem>_frames.csv` and
/// `<stem>_events.csv` in `folder`. The first line names the columns with their units; `time_s` counts from
/// the session's start. Numbers have enough digits to restore their bits. Only one message at a time is in
/// memory.
/// @param progress  called now and then with the fraction of the file that is done
/// The error names file, byte and reason if the recording cannot be read, or the path of a table that cannot
/// be written.
[[nodiscard]] tl::expected<ExportedTables, std::string> ExportTables(
    const std::filesystem::path& recording, const std::filesystem::path& folder, const std::string& stem,
    const std::function<void(double share)>& progress = {});

/// Writes some ticks of a recording as a table of ticks. @param start  stamp at which `time_s` is 0
/// The error names the path.
[[nodiscard]] tl::expected<void, std::string> ExportTicks(std::span<const control::TickRecord> ticks,
                                                          rt::Nanoseconds start,
                                                          const std::filesystem::path& path);

}  // namespace osteon::session
