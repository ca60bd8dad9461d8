#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "control/laws/admittance_law.h"

namespace osteon::studies {

/// Figures of a run from its recording: whether the recording is complete, the largest values, and the sums
/// for the balances of momentum, energy and volume.
struct EpisodeFigures {
  bool complete{false};  ///< whether the file has a proper end
  std::uint64_t ticks{0}, frames{0};
  /// Number of ticks that are missing between recorded ticks.
  std::uint64_t missing_ticks{0};
  double rendered_s{0.0};                              ///< time in which the loop rendered
  double max_model_age_s{0.0}, max_sensor_age_s{0.0};  ///< largest ages while rendering
  double peak_rendered_N{0.0};
  double max_tracking_m{0.0};  ///< largest distance of the measured from the commanded apex, while rendering
  double rest_error_m{0.0};    ///< distance of the measured from the commanded apex in the last tick
  /// Residual of the virtual tool's momentum balance, M v' = F_hand + F_rendered - D v, divided by the hand's
  /// impulse. Summed over ticks in which no limit acted.
  double momentum_residual{0.0};
  double edge_work_J{0.0};                      ///< work of the edge: spindle torque × angle
  double cutting_work_J{0.0}, removed_m3{0.0};  ///< totals in the last frame
  /// Whether the removed volume fell from one frame to the next.
  bool removed_falls{false};
  double min_tank_J{0.0};

  /// Difference of the edge's work from the energy of the cleared bone, divided by that energy; 0 if nothing
  /// was cut.
  /// @param debt_J  cutting debt: work for cleared bone that the edge has not yet done; negative: work done
  /// for bone that is not yet cleared
  [[nodiscard]] double EnergyResidual(double debt_J) const {
    return cutting_work_J > 0.0 ? (edge_work_J - cutting_work_J + debt_J) / cutting_work_J : 0.0;
  }
};

/// Reads a recording, one message after the other. @param law  admittance law of the cell
/// @param period_s  period of the cell's loop
/// @returns an error that names the file.
[[nodiscard]] tl::expected<EpisodeFigures, std::string> ReadEpisodeFigures(
    const std::filesystem::path& recording, const control::AdmittanceParams& law, double period_s);

}  // namespace osteon::studies
