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
[[nodiscard]] EngineProcessSection ReadEngineProcess(Reader section);

/// Converts the section. `process` is `inside` (no process of its own), `local`, or "HOST:PORT" of an
/// `osteon simulate` that listens there.
/// @throws ConfigError for any other `process`, for an engine beyond the loopback without `token_file`, and
///   for any other engine with one.
[[nodiscard]] std::optional<EngineProcessConfig> CheckEngineProcess(const EngineProcessSection& read);

}  // namespace osteon::config
