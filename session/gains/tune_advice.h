#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"

namespace osteon::session {

/// The result of `osteon tune` for a cell and its gains, from tune.json.
struct TuneAdvice {
  std::string file;
  double asked_margin{0.0};  ///< gain margin that was asked for
  double own_margin{
      0.0};  ///< gain margin of the cell's own gains; 0: not stable with all hands and contacts of tune
  double worst_age_s{0.0};  ///< age of the contact planes for which the margins hold
  /// Recommended gains and their margin; absent: no gains are stable with all hands and contacts of tune.
  struct Recommended {
    std::optional<double> mass_kg, stiffness_N_per_m;
    double drag_Ns_per_m{0.0}, margin{0.0};
  };
  std::optional<Recommended> recommended{};
  /// Pairs of a drag of the virtual tool [N s/m] and the stiffest wall that is predicted to be stable with
  /// this drag [N/m]; empty: there is no map for the cell's own mass.
  std::vector<std::pair<double, double>> boundary{};

  /// Returns the stiffest stable wall at a drag [N/m]. Between two drags of the map it is the smaller of
  /// their two values, since stability is not monotone there. Nothing if the drag is beyond the map.
  [[nodiscard]] std::optional<double> WallAt(double drag_Ns_per_m) const;
};

/// The file in which `osteon tune` leaves its result without --out.
inline constexpr const char* kTuneFile = "tune/tune.json";

/// Reads tune.json for a cell. @param name  name of the cell's file, without the ending
/// @returns an error if the file is no tune.json, or is for another cell, law, period or other gains than the
/// cell's; the error names the value found and the cell's
[[nodiscard]] tl::expected<TuneAdvice, std::string> ReadTuneAdvice(const std::filesystem::path& file,
                                                                   const config::CellConfig& cell,
                                                                   const std::string& name);

}  // namespace osteon::session
