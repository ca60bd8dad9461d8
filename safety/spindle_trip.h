#pragma once

#include <limits>

#include "control/rt/marker.h"

namespace osteon::safety {

/// What a spindle may do, and for how long more. Infinite: no bound.
struct SpindleLimitParams {
  double max_torque_Nm{std::numeric_limits<double>::infinity()};        ///< > 0
  double max_speed_rad_per_s{std::numeric_limits<double>::infinity()};  ///< > 0
  double trip_s{0.1};  ///< without a pause, until the trip; a start-up takes its torque for less; >= 0
};

/// Trips where the spindle's torque or speed, either sign, is beyond its limit for some time: a tool that has
/// jammed, a drive that runs away.
class SpindleTrip {
 public:
  /// @throws std::invalid_argument naming the field, the value and what is accepted.
  explicit SpindleTrip(const SpindleLimitParams& params);

  /// True where the cell must stop. Once a tick; a value that is not finite is beyond every limit.
  [[nodiscard]] bool Check(double torque_Nm, double speed_rad_per_s, double dt_s) OSTEON_RT;
  void Reset() OSTEON_RT { beyond_s_ = 0.0; }

 private:
  SpindleLimitParams params_;
  double beyond_s_{0.0};
};

}  // namespace osteon::safety
