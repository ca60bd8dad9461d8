#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/marker.h"
#include "safety/acting_limits.h"
#include "safety/depth_limit.h"

namespace osteon::control {

/// Peaks and counts since the start of the run.
struct ServoStatistics {
  double peak_coupling_force_N{0.0};  ///< rendered force, after all limits
  double peak_coupling_torque_Nm{0.0};
  double peak_sensor_force_N{0.0};      ///< hand's force, from the sensor
  double peak_tool_speed_m_per_s{0.0};  ///< commanded speed
  double peak_tool_in_bone_m{0.0};      ///< distance from the tool to its proxy
  double peak_power_W{0.0};             ///< power from the coupling to the hand, in the commanded motion
  /// Measured from message to message while the loop commands the arm, including the path to the start and
  /// stops.
  double peak_measured_tool_speed_m_per_s{0.0};
  double peak_tracking_error_m{0.0};
  safety::LimitCounts limits;                                        ///< ticks in which each limit acted
  double min_depth_left_m{std::numeric_limits<double>::infinity()};  ///< distance to the reamer's depth limit
  double min_tank_J{std::numeric_limits<double>::infinity()};
  /// Number of messages in COMMANDING_ACTIVE, except while the loop waits or moves to the start.
  std::uint64_t active_ticks{0};
  std::uint64_t missed_messages{0};  ///< deadlines that passed without a message, except while waiting

  /// Updates min_depth_left_m. Call in each tick that renders.
  void CountDepthLeft(const safety::DepthLimit& limit) OSTEON_RT {
    if (limit.acts()) min_depth_left_m = std::min(min_depth_left_m, limit.distance_m());
  }
};

}  // namespace osteon::control
