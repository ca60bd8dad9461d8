#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "procedure/assessment/sphere_fit.h"

namespace osteon::studies {

/// A tissue of the scene that gets the figures of a shipped material.
struct TissueFigures {
  std::string tissue;    ///< of the scene: "cancellous"
  std::string material;  ///< of sawbone.yaml: "foam_10"
};

/// A shipped cell with its simulated arm, hand and devices, run in virtual time.
struct CellTrialParams {
  std::string cell{"demo"};        ///< a name under cells/
  std::vector<std::string> set{};  ///< overrides of the cell, KEY=VALUE each
  std::vector<TissueFigures> tissues{};
  double seconds{10.0};
  std::optional<double> error_m{};  ///< packing error; none: as the cell's scene demands
  /// true: uses the packing that the scene's file gives, without a plan for an error
  bool as_packed{false};

  /// A text that is equal only for equal parameters.
  [[nodiscard]] std::string Key() const;
};

/// The outcome of the run.
struct CellTrial {
  std::string ended;                ///< how the run ended: "completed"
  std::vector<std::string> faults;  ///< names of the faults of the run
  /// sphere fitted to the cavity; nothing if the bone has no cup or was not cut
  std::optional<procedure::SphereFit> fit;
  std::string fit_refused;  ///< why there is no fit
  /// Distance along the axis by which the fitted centre lies below the cup's. 0 or less: the head is not
  /// seated.
  double seated_m{0.0};
  double centre_shift_m{0.0};  ///< distance of the fitted centre from the cup's centre
  double removed_m3{0.0};
  double peak_hand_N{0.0}, peak_rendered_N{0.0};
  double feed_per_turn_m{0.0};   ///< feed of the head along the site's axis, while the hand presses in full
  double force_difference{0.0};  ///< mean of |hand + rendered| / |rendered|, while pressing in full
  double pressed_s{0.0};  ///< time in which the hand pressed in full; 0: the two figures above are not known
  double seconds_wall{0.0};
};

/// Runs a cell in the calling thread. The result is reproducible.
/// @param config_root  folder that contains cells/ and materials/
/// @returns an error if the cell cannot be set up or run. @throws config::ConfigError
[[nodiscard]] tl::expected<CellTrial, std::string> RunCellTrial(const std::filesystem::path& config_root,
                                                                const CellTrialParams& params);

}  // namespace osteon::studies
