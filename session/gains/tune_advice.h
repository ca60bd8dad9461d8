#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"

namespace osteon::session {

/// The result of `osteon tune` for a cell and its gains, as its tune.json says.
struct TuneAdvice {
  std::string file;
  double asked_margin{0.0};  ///< gain margin that was asked for
  double own_margin{0.0};    ///< of the cell's own gains; 0: not stable with all
  double worst_age_s{0.0};   ///< of the planes, that the margins are of
  /// Recommended gains and their margin; absent: none are stable with all.
  struct Recommended {
    std::optional<double> mass_kg, stiffness_N_per_m;
    double drag_Ns_per_m{0.0}, margin{0.0};
  };
  std::optional<Recommended> recommended{};
  /// Stiffest wall that is stable by prediction with a drag of the virtual tool [N s/m, N/m]; empty: not
  /// mapped at the cell's own mass.
  std::vector<std::pair<double, double>> boundary{};

  /// The stiffest stable wall at a drag: the lower one of both neighbours of the map, since stability is not
  /// monotone between them. Nothing beyond the map.
  [[nodiscard]] std::optional<double> WallAt(double drag_Ns_per_m) const;
};

/// Where `osteon tune` leaves its result without --out.
inline constexpr const char* kTuneFile = "tune/tune.json";

/// Reads tune.json for a cell. @param name  of its file, without the ending
/// @returns an error for a file that cannot be read, or that is of another cell, law, period, or of other
/// gains than the cell has: it names both
[[nodiscard]] tl::expected<TuneAdvice, std::string> ReadTuneAdvice(const std::filesystem::path& file,
                                                                   const config::CellConfig& cell,
                                                                   const std::string& name);

}  // namespace osteon::session
