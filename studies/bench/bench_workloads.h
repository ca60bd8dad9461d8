#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace osteon::studies {

/// A workload that `osteon bench frame` times by its name.
struct BenchWorkload {
  const char* name;
  const char* scene;  ///< BenchFrameOptions::scene
  std::size_t spheres, tool_spheres;
};

/// The workloads on which engines are compared: bones of growing size under one analytic head, then heads of
/// many spheres.
inline constexpr std::array<BenchWorkload, 6> kBenchWorkloads{{{"reamer-30k", "acetabulum", 30'000, 1},
                                                               {"reamer-300k", "acetabulum", 300'000, 1},
                                                               {"reamer-1m", "acetabulum", 1'000'000, 1},
                                                               {"burr-200", "molar", 36'000, 200},
                                                               {"reamer-200", "acetabulum", 35'000, 200},
                                                               {"reamer-1000", "acetabulum", 300'000, 1000}}};

/// The values of `--workloads`: "all", then the workloads' names.
[[nodiscard]] const std::vector<std::string>& BenchWorkloadNames();

/// Returns the named workloads in the order of kBenchWorkloads, each once; all if "all" is among the names.
[[nodiscard]] std::vector<BenchWorkload> SelectWorkloads(const std::vector<std::string>& names);

}  // namespace osteon::studies
