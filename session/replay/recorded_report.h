#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// The options of `osteon report`.
struct RecordedReportOptions {
  std::filesystem::path recording;
  std::filesystem::path out{};       ///< folder for the pages; empty: the recording's own
  std::filesystem::path json{};      ///< file for the summary, as of `osteon run`; empty: none
  std::optional<MeshChoice> mesh{};  ///< the bone, if it was from a file that the recording does not name
  std::string command_line{};        ///< shown on the page
};

/// Runs `osteon report`: makes the report of a recording, and the pages of its stops. The bone is cut again
/// along the recorded motion, packed as the run packed it. For a recording of a session, the bone and the
/// last saved state are read from the session's folder instead.
/// @returns the process's exit code: 0; 1 a file could not be written; 2 the recording, or its bone, cannot
/// be read.
[[nodiscard]] int RunRecordedReport(const RecordedReportOptions& options);

}  // namespace osteon::session
