#pragma once

#include <filesystem>
#include <string>

namespace osteon::app {

/// Options of `osteon faults`: what can stop the cell, and how to continue.
struct FaultsOptions {
  std::filesystem::path markdown{};  ///< the documentation's page; empty: not written
  std::filesystem::path json{};
};

/// Renders the catalogue of faults as the page docs/faults.md.
[[nodiscard]] std::string FaultsPage();

/// Prints the faults, and writes the files that the options name.
/// @returns the process's exit code.
[[nodiscard]] int RunFaults(const FaultsOptions& options);

}  // namespace osteon::app
