#pragma once

#include <filesystem>
#include <string>

namespace osteon::app {

/// `osteon states`: what the cell does, and what leads from one state to another.
struct StatesOptions {
  std::filesystem::path markdown{};  ///< the documentation's page; empty: not written
  std::filesystem::path json{};
};

/// The state machine as the page docs/states.md, from its table.
[[nodiscard]] std::string StatesPage();

/// @returns the process's exit code.
[[nodiscard]] int RunStates(const StatesOptions& options);

}  // namespace osteon::app
