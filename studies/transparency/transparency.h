#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "session/summary/verdict.h"
#include "studies/transparency/handle_bench.h"

namespace osteon::studies {

/// Options of `osteon transparency`.
struct TransparencyOptions {
  std::filesystem::path cell;
  std::filesystem::path out{"transparency"};
  std::filesystem::path json{};  ///< a second copy of transparency.json
  std::filesystem::path
      identified{};  ///< a file of `osteon identify`; empty: the file that the cell's file names, if any
  int points{25};    ///< number of frequencies, evenly spaced in the logarithm
  int sensor_delay_ticks{1};
  std::string command_line{};
};

/// The range of the measured frequencies.
inline constexpr double kTransparencyMin_hz = 0.1, kTransparencyMax_hz = 30.0;
/// Upper end of the band of hand motion. Mass and drag are fitted, and the residual is computed, up to this
/// frequency.
inline constexpr double kTransparencyFit_hz = 3.0;

/// The measurement along or about one axis of the tool in free motion.
struct TransparencyAxis {
  int axis{0};  ///< 0 … 2: along x, y, z of T; 3 … 5: about x, y, z of T
  std::vector<HandlePoint> points;
  HandleFit fit;
  /// requested values; [kg, N s/m], for a rotation [kg m^2, N m s/rad]
  double asked_mass{0.0}, asked_drag{0.0};
  /// rms of |Z - asked| / |asked| over the band of hand motion; Z is the measured impedance, asked the
  /// requested one.
  double residual{0.0};
};

/// The impedance at the handle, measured and requested, in free motion and in contact.
struct TransparencyResult {
  std::string cell;
  std::vector<TransparencyAxis> axes;   ///< one for each of the six axes
  std::vector<HandlePoint> contact;     ///< along z, against a plane perpendicular to z
  double asked_stiffness_N_per_m{0.0};  ///< requested stiffness: that of the plane
  /// Damping of the coupling. The coupling limits it if it would add more than its permitted share of the
  /// force.
  double asked_damping_Ns_per_m{0.0};
  double stiffness_N_per_m{0.0};                    ///< measured stiffness, at the lowest frequency
  double preload_N{0.0}, contact_amplitude_N{0.0};  ///< mean and amplitude of the hand's force in contact
  /// The main figure: the largest residual of the three translations, along which the hand leads the tool.
  [[nodiscard]] double free_residual() const;
  [[nodiscard]] double apparent_mass_kg() const;  ///< largest of the three translations
  [[nodiscard]] double drag_Ns_per_m() const;     ///< largest of the three translations
  [[nodiscard]] bool fault() const;
};

/// Bad if the loop stopped, or if an error is as large as the requested impedance. A warning if a hand may
/// notice the error, in free motion or in contact.
[[nodiscard]] session::Verdict Judge(const TransparencyResult& result);

/// Excites the cell's own loop and simulated arm at the cell's start. A known wrench replaces the hand, so
/// the result contains no mass and stiffness of a hand.
[[nodiscard]] TransparencyResult MeasureTransparency(const config::CellConfig& cell,
                                                     const TransparencyOptions& options);

/// Runs `osteon transparency CELL.yaml`: writes transparency.svg, .png, .csv, .json, .html into a folder and
/// a table to stdout.
/// @returns the process's exit code: 0; 1 if the verdict is bad or a file can't be written; 2 bad input.
[[nodiscard]] int RunTransparency(const TransparencyOptions& options);

}  // namespace osteon::studies
