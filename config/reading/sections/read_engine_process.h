#pragma once

#include <optional>
#include <string>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// A cell's section `simulation` as it was read, for CheckEngineProcess.
struct EngineProcessSection {
  Reader section;
  std::string process;
  std::optional<std::string> token_file;
};
/// Reads the section without checking the values, which are valid only after Finish().
[[nodiscard]] EngineProcessSection ReadEngineProcess(Reader section);

/// Checks and converts the section, after Finish(). `process` is `inside` (no process of its own), `local`,
/// or "HOST:PORT" of an `osteon simulate` that listens there.
/// @returns nothing for `inside`
/// @throws ConfigError for any other `process`, for an engine beyond the loopback without `token_file`, and
///   for `inside` or `local` with one.
[[nodiscard]] std::optional<EngineProcessConfig> CheckEngineProcess(const EngineProcessSection& read);

}  // namespace osteon::config
