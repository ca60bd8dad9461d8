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
  std::optional<std::size_t> count{};  ///< of balls; none: by the scene or the defaults, as those below
  std::optional<double> r_min_mm{}, r_max_mm{}, grade{};
  std::uint64_t seed{0};
  int threads{0};     ///< 0: one per core
  bool points{true};  ///< mass points are made
  std::optional<double> point_spacing_mm{};
  std::filesystem::path report{};  ///< folder; empty: none
  std::filesystem::path json{};
  std::string command_line{};
  std::vector<std::string> packing_options{};  ///< given options that do not apply to a packing file
};

/// Fills a mesh or shape with balls and mass points and saves them, or saves a packing file in other formats.
/// Prints figures of its quality.
/// @returns the process's exit code: 0 done; 1 a tolerance was not kept, or a result could not be written; 2
/// wrong input, nothing was written (both said on stderr); 130 ended by Ctrl-C, all present files complete.
[[nodiscard]] int RunPack(const PackOptions& options);

}  // namespace osteon::studies
