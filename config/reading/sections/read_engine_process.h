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

/// `process` is `inside` (none), `local`, or "HOST:PORT" of an `osteon simulate` that listens there.
/// @throws ConfigError for another one, and if an engine beyond the loopback has no `token_file`, or any
/// other
///   has one.
[[nodiscard]] std::optional<EngineProcessConfig> CheckEngineProcess(const EngineProcessSection& read);

}  // namespace osteon::config
