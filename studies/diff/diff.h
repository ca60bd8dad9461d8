#pragma once

#include <array>
#include <filesystem>
#include <string>

namespace osteon::studies {

/// Options of `osteon diff`.
struct DiffOptions {
  std::array<std::filesystem::path, 2> recordings{};
  /// Two values of a figure count as the same if they differ by at most this share of its size [%].
  double within_percent{1.0};
  std::filesystem::path out{};   ///< folder for diff.html; empty: no page
  std::filesystem::path json{};  ///< osteon.diff/1; empty: none
  std::string command_line{};    ///< shown on the page
};

/// Runs `osteon diff`: compares two recordings by their figures, faults, limits and configuration. Two
/// recordings of `osteon identify` are also compared by their excitation and by the results that identify
/// estimates from them.
/// @returns the process's exit code: 0 no figure differs and no fault is new; 1 a figure differs or a fault
/// is new; 2 a recording can't be read, or the two are of different kinds.
[[nodiscard]] int RunDiff(const DiffOptions& options);

}  // namespace osteon::studies
