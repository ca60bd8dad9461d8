#pragma once

#include <vector>

#include "simulation/metrics/carved_shape.h"
#include "simulation/metrics/force_error.h"
#include "simulation/metrics/workloads.h"

namespace osteon::simulation {

/// How far a method's cut and its touch are off the exact ones.
struct WorkloadScores {
  double depth_error_m{0.0};        ///< bone lost beyond the sweep and left within it, over the cut's area
  double depth_error_se_m{0.0};     ///< standard error of the part that was lost
  double lost_m{0.0}, left_m{0.0};  ///< the two parts
  double probe_p95_m{0.0};          ///< gap that a ball of 1 mm feels at the cut
  double volume_error{0.0};         ///< |removed by the method's books / swept - 1|
  double swept_volume_m3{0.0};
  ForceErrors force;   ///< of the touch
  double ripple{0.0};  ///< 5 to 500 Hz (ripple.h), over the exact mean force
};

/// @param before, after  what the method has of the bone before the cut and at the end
/// @param run            a complete one
/// @param surface_cells  see AccuracyParams
/// @throws std::invalid_argument where the run is not complete.
[[nodiscard]] WorkloadScores ScoreWorkload(const CutWorkload& workload, const WorkloadRun& run,
                                           const CarvedShape& before, const CarvedShape& after,
                                           std::size_t surface_cells = 20'000);

/// Root mean squares over several workloads, but for `force`, of which relative error, torque and normal are
/// averaged alike and jumps are the greatest.
[[nodiscard]] WorkloadScores Combined(const std::vector<WorkloadScores>& scores);

}  // namespace osteon::simulation
