#pragma once

#include <filesystem>
#include <string>

namespace osteon::app {

/// Options of `osteon states`: the cell's states and their transitions.
struct StatesOptions {
  std::filesystem::path markdown{};  ///< the documentation's page; empty: not written
  std::filesystem::path json{};
};

/// Renders the state machine's table as the page docs/states.md.
[[nodiscard]] std::string StatesPage();

/// Prints the states with their transitions, and writes the files that the options name.
/// @returns the process's exit code.
[[nodiscard]] int RunStates(const StatesOptions& options);

}  // namespace osteon::app
