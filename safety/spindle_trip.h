#pragma once

#include <limits>

#include "base/marker.h"

namespace osteon::safety {

/// Limits of a spindle, and how long it may exceed them. Infinite: no bound.
struct SpindleLimitParams {
  double max_torque_Nm{std::numeric_limits<double>::infinity()};        ///< > 0
  double max_speed_rad_per_s{std::numeric_limits<double>::infinity()};  ///< > 0
  /// Uninterrupted time beyond a limit after which the trip occurs; >= 0. It must be longer than the
  /// spindle's start-up, which may exceed the torque limit.
  double trip_s{0.1};
};

/// Trips if the spindle's torque or speed, of either sign, exceeds its limit for some time: the tool has
/// jammed, or the drive is out of control.
class SpindleTrip {
 public:
  /// @throws std::invalid_argument naming the field, the value and what is accepted.
  explicit SpindleTrip(const SpindleLimitParams& params);

  /// True if the cell must stop. Call once per tick; a value that is not finite exceeds every limit.
  [[nodiscard]] bool Check(double torque_Nm, double speed_rad_per_s, double dt_s) OSTEON_RT;
  void Reset() OSTEON_RT { beyond_s_ = 0.0; }

 private:
  SpindleLimitParams params_;
  double beyond_s_{0.0};  // uninterrupted time beyond a limit so far
};

}  // namespace osteon::safety
