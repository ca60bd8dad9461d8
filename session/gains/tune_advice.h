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
  double asked_margin{0.0};  ///< gain margin that tune was asked for
  double own_margin{0.0};    ///< gain margin of the cell's own gains; 0: they are not stable with every hand
                             ///< and contact that tune tests
  double worst_age_s{0.0};   ///< largest age of the contact planes at which the margins hold
  /// Recommended gains and their margin; absent: no gains are stable with every hand and contact that tune
  /// tests.
  struct Recommended {
    std::optional<double> mass_kg, stiffness_N_per_m;
    double drag_Ns_per_m{0.0}, margin{0.0};
  };
  std::optional<Recommended> recommended{};
  /// The map of stable walls: pairs of a drag of the virtual tool [N s/m] and the stiffness of the stiffest
  /// wall that is predicted to be stable with this drag [N/m]. Empty: there is no map for the cell's own
  /// mass.
  std::vector<std::pair<double, double>> boundary{};

  /// Returns the stiffness of the stiffest stable wall at a drag [N/m]. Between two drags of the map it is
  /// the smaller of their values, because stability is not monotone between them. Nothing if the drag is
  /// outside the map.
  [[nodiscard]] std::optional<double> WallAt(double drag_Ns_per_m) const;
};

/// The file to which `osteon tune` writes its result if there is no --out.
inline constexpr const char* kTuneFile = "tune/tune.json";

/// Reads tune.json for a cell. @param name  name of the cell's file, without the ending
/// @returns the advice, or an error if the file is not a tune.json, or was made for another cell, law or
/// period or for other gains than the cell's. The error names the value found and the cell's value.
[[nodiscard]] tl::expected<TuneAdvice, std::string> ReadTuneAdvice(const std::filesystem::path& file,
                                                                   const config::CellConfig& cell,
                                                                   const std::string& name);

}  // namespace osteon::session
