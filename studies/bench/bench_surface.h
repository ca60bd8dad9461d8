#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace osteon::studies {

/// Options of `osteon bench surface`.
struct BenchSurfaceOptions {
  std::filesystem::path config_root;
  std::vector<std::string> cells{"demo", "molar"};  ///< names under cells/
  /// Voxel sizes; empty: 2, 1 and 0.5 times the size for the tool (VoxelFor)
  std::vector<double> voxels_mm{};
  std::size_t frames{1600};  ///< of the cut; 16 frames are a step
  std::filesystem::path json{};
};

/// Measures the times of the carved surface: the time of the start, and the times to carve, to extract and to
/// pack (for a page) each step of 16 frames. The tool circles 1 mm off the site's axis and is fed in by 5 um
/// per frame.
/// @returns the process's exit code: 0; 1 if the figures can't be written; 2 for bad input; 130 if ended by
///   Ctrl-C.
[[nodiscard]] int RunBenchSurface(const BenchSurfaceOptions& options);

}  // namespace osteon::studies
