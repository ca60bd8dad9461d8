#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "control/laws/admittance_law.h"

namespace osteon::studies {

/// Figures of a run from its recording: whether the recording is complete, the largest values, and the sums
/// for the balances of momentum, energy and volume.
struct EpisodeBooks {
  bool complete{false};  ///< the file has its end
  std::uint64_t ticks{0}, frames{0};
  std::uint64_t missing_ticks{0};                      ///< gaps in the ticks' numbers
  double rendered_s{0.0};                              ///< time in which the loop rendered
  double max_model_age_s{0.0}, max_sensor_age_s{0.0};  ///< while rendering
  double peak_rendered_N{0.0};
  double max_tracking_m{0.0};  ///< between commanded and measured apex, while rendering
  double rest_error_m{0.0};    ///< the same in the last tick
  /// Momentum of the virtual tool: residual of M v' = F_hand + F_rendered - D v divided by the hand's
  /// impulse, summed over ticks in which no limit acted.
  double momentum_residual{0.0};
  double edge_work_J{0.0};                      ///< spindle torque × angle
  double cutting_work_J{0.0}, removed_m3{0.0};  ///< totals, as of the last frame
  bool removed_falls{false};                    ///< the removed volume once fell from a frame to the next
  double min_tank_J{0.0};

  /// Work of the edge less the energy of the cleared bone, divided by that energy; 0 if nothing was cut.
  /// @param debt_J  work of cleared bone that the edge has not yet done; negative: of bone not cleared yet
  [[nodiscard]] double EnergyResidual(double debt_J) const {
    return cutting_work_J > 0.0 ? (edge_work_J - cutting_work_J + debt_J) / cutting_work_J : 0.0;
  }
};

/// Reads a recording, one message after the other. @param law  of the cell; @param period_s  of its loop
/// @returns an error that names the file.
[[nodiscard]] tl::expected<EpisodeBooks, std::string> ReadBooks(const std::filesystem::path& recording,
                                                                const control::AdmittanceParams& law,
                                                                double period_s);

}  // namespace osteon::studies
