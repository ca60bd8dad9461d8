#pragma once

#include <cstdint>
#include <limits>

#include "safety/acting_limits.h"

namespace osteon::control {

/// Peaks and counts since the start.
struct ServoStatistics {
  double peak_coupling_force_N{0.0};  ///< rendered: after every limit, as integrated
  double peak_coupling_torque_Nm{0.0};
  double peak_sensor_force_N{0.0};      ///< what the sensor said
  double peak_tool_speed_m_per_s{0.0};  ///< commanded
  double peak_tool_in_bone_m{0.0};      ///< from the tool to its collision-free pose
  double peak_power_W{0.0};             ///< from the coupling to the hand, of the motion that was commanded
  /// Between two messages, while the loop commands the arm: also on its way to the start and in a stop.
  double peak_measured_tool_speed_m_per_s{0.0};
  double peak_tracking_error_m{0.0};
  safety::LimitCounts limits;                                        ///< while rendering
  double min_depth_left_m{std::numeric_limits<double>::infinity()};  ///< to the reamer's depth limit
  double min_tank_J{std::numeric_limits<double>::infinity()};
  std::uint64_t active_ticks{0};     ///< messages answered in COMMANDING_ACTIVE, once the loop has begun
  std::uint64_t missed_messages{0};  ///< deadlines that passed without one, once commanding
};

}  // namespace osteon::control
