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
/// Reads the section. The values are valid only after Finish(), and CheckEngineProcess checks them.
[[nodiscard]] EngineProcessSection ReadEngineProcess(Reader section);

/// Checks and converts the section, after Finish(). `process` is `inside` (no process of its own), `local`,
/// or "HOST:PORT" of an `osteon simulate` that listens there.
/// @returns nothing for `inside`
/// @throws ConfigError for any other `process`, for an engine at an address other than the loopback's without
///   `token_file`, and for `token_file` together with `inside` or `local`.
[[nodiscard]] std::optional<EngineProcessConfig> CheckEngineProcess(const EngineProcessSection& read);

}  // namespace osteon::config
