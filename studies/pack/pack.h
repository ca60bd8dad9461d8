#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "session/planning/pack_source.h"

namespace osteon::studies {

/// Command line of `osteon pack`.
struct PackOptions {
  session::SourceOptions source;
  std::vector<std::filesystem::path> outputs;  ///< .osp, .ply, .csv
  bool disjoint{false};                        ///< no two balls overlap
  /// Number of balls; none: by the scene or the defaults, as for the options below.
  std::optional<std::size_t> count{};
  std::optional<double> r_min_mm{}, r_max_mm{}, grade{};
  std::uint64_t seed{0};
  int threads{0};     ///< 0: one per core
  bool points{true};  ///< mass points are made
  std::optional<double> point_spacing_mm{};
  std::filesystem::path report{};  ///< folder; empty: none
  std::filesystem::path json{};
  std::string command_line{};
  /// Given options that do not apply if a packing file is converted.
  std::vector<std::string> packing_options{};
};

/// Fills a mesh or shape with balls and mass points and saves them, or converts a packing file to other
/// formats. Prints figures of the packing's quality.
/// @returns the process's exit code: 0 done; 1 a tolerance was not kept, or a result could not be written; 2
/// wrong input, nothing was written (1 and 2 with the reason on stderr); 130 ended by Ctrl-C, all files that
/// exist are complete.
[[nodiscard]] int RunPack(const PackOptions& options);

}  // namespace osteon::studies
