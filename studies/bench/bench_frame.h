#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "studies/bench/frame_timing.h"

namespace osteon::studies {

/// Options of `osteon bench frame`.
struct BenchFrameOptions {
  std::filesystem::path config_root;
  std::string scene{"acetabulum"};  ///< or "molar", which is timed with its recorded motion and burr
  std::size_t spheres{0};           ///< 0: the scene's own packing
  bool uniform{false};  ///< true: the same fineness in the whole bone; false: fine only in the cut zone
  std::size_t tool_spheres{1};
  std::string method{"ours"};
  std::vector<std::string> compare{};  ///< further methods, timed in the same run; empty: none
  /// Engines that are timed in turn instead of methods: "vulkan", "cpu", "reference"; empty: none.
  std::vector<std::string> engines{};
  /// Names of workloads (BenchWorkloadNames) that are timed in place of `scene` and `tool_spheres`. If
  /// `spheres` is not 0, each of their bones has that many balls instead of its own number.
  std::vector<std::string> workloads{};
  std::size_t rounds{1};  ///< number of rounds over all workloads
  std::string device{};
  std::size_t frames{2000};  ///< number of frames timed per round and workload
  double max_seconds{60.0};  ///< time limit of the timing per round and workload
  double voxel_mm{0.25};
  std::filesystem::path json{};
};

/// Makes the workload of `scene`, `tool_spheres` and `spheres`, and packs its bone; `workloads` is not read.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] simulation::FrameWorkload MakeBenchWorkload(const BenchFrameOptions& options);

/// Times the workloads' frames and prints the figures.
/// @returns the process's exit code: 0; 1 if it can't run here; 2 for bad input; 130 if ended by Ctrl-C.
[[nodiscard]] int RunBenchFrame(const BenchFrameOptions& options);

/// Peak memory of this process so far [MB].
[[nodiscard]] double PeakMemory_MB();

}  // namespace osteon::studies
