#pragma once

#include <vector>

#include "simulation/fidelity/carved_shape.h"
#include "simulation/fidelity/force_error.h"
#include "simulation/fidelity/workloads.h"

namespace osteon::simulation {

/// Errors of a method's cut and forces against the exact cut and forces.
struct WorkloadScores {
  double depth_error_m{0.0};        ///< (bone lost beyond the sweep + bone left within it) / the cut's area
  double depth_error_se_m{0.0};     ///< standard error of lost_m
  double lost_m{0.0}, left_m{0.0};  ///< the two parts of depth_error_m
  /// 95th percentile of the gap between a probe ball of 1 mm radius on the exact cut and the bone
  double probe_p95_m{0.0};
  double volume_error{0.0};  ///< |removed volume by the method's own count / swept volume - 1|
  double swept_volume_m3{0.0};
  ForceErrors force;   ///< during the touch
  double ripple{0.0};  ///< rms of 5 to 500 Hz (ripple.h) / the exact mean force
};

/// Scores a method's run of a workload.
/// @param before, after  the method's bone before the cut and at the end
/// @param run  a complete run
/// @param surface_cells  see AccuracyParams
/// @throws std::invalid_argument if the run is not complete.
[[nodiscard]] WorkloadScores ScoreWorkload(const CutWorkload& workload, const WorkloadRun& run,
                                           const CarvedShape& before, const CarvedShape& after,
                                           std::size_t surface_cells = 20'000);

/// Combines the scores of several workloads: the largest value of each maximum and jump, and the root mean
/// square of every other figure. `force.touched` is true if it is true for every workload.
[[nodiscard]] WorkloadScores Combined(const std::vector<WorkloadScores>& scores);

}  // namespace osteon::simulation
