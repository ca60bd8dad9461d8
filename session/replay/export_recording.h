#pragma once

#include <filesystem>
#include <optional>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// The options of `osteon export`.
struct ExportOptions {
  std::filesystem::path recording;
  bool csv{false};                 ///< write tables; also done if nothing else is requested
  bool recover{false};             ///< rebuild a complete recording from a torn one
  std::filesystem::path out;       ///< folder for the results; empty: the recording's own
  std::filesystem::path surface;   ///< file for the carved bone as a mesh
  std::optional<double> at_s;      ///< surface: time since the recording's start; none: its end
  double drop_below_mm3{0.0};      ///< surface: smaller loose pieces are left out
  std::filesystem::path foxglove;  ///< file for a copy with the carved bone; empty: none
  double every_s{0.5};             ///< foxglove: log time from one state of the bone to the next
  std::optional<MeshChoice> mesh;  ///< surface, foxglove: the bone, if the run's bone was from a file
  std::filesystem::path json;      ///< file for the result; empty: none
};

/// Runs `osteon export`.
/// @returns the process's exit code: 0 done; 1 something could not be written; 2 the recording cannot be
/// read, or a path is wrong (said on stderr).
[[nodiscard]] int RunExport(const ExportOptions& options);

}  // namespace osteon::session
