#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/frame_timing.h"

namespace osteon::app {

/// `osteon bench frame`.
struct BenchFrameOptions {
  std::filesystem::path config_root;
  std::string scene{"acetabulum"};  ///< or molar: its recorded motion, and its burr
  std::size_t spheres{0};           ///< 0: the scene's own packing
  bool uniform{false};
  std::size_t tool_spheres{1};
  std::string method{"ours"};
  std::string compare{};  ///< a further method in the same run; empty: none
  std::string device{};
  std::size_t frames{2000};
  double most_seconds{60.0};
  double voxel_mm{0.25};
  std::filesystem::path json{};
};

/// The workload that the options ask for, packed.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] simulation::FrameWorkload MakeBenchWorkload(const BenchFrameOptions& options);

/// Times it and prints the figures.
/// @returns the process's exit code: 0; 1 where it can't be run here; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunBenchFrame(const BenchFrameOptions& options);

/// Most memory that this process has had so far [MB].
[[nodiscard]] double PeakMemory_MB();

}  // namespace osteon::app
