#pragma once

#include <filesystem>
#include <optional>

namespace osteon::studies {

/// Options of `osteon bench kinematics`.
struct BenchKinematicsOptions {
  std::filesystem::path config_root;
  std::filesystem::path robot{};  ///< a file of config/robots; empty: the LBR iiwa 14
  /// Number of calls of each function; KDL's numerical inverse gets a hundredth of it
  std::size_t calls{100'000};
  std::filesystem::path json{};
};

/// Times the arm's mathematics and KDL's alternately, batch by batch, and prints the medians.
/// @returns the process's exit code: 0; 1 if the figures can't be written; 2 for bad input; 130 if ended by
///   Ctrl-C.
[[nodiscard]] int RunBenchKinematics(const BenchKinematicsOptions& options);

}  // namespace osteon::studies
