#pragma once

#include <functional>
#include <span>
#include <string>

#include "app/report/time_axis.h"
#include "control/ports.h"
#include "control/servo_params.h"
#include "control/tick_record.h"
#include "safety/fault.h"
#include "safety/zone.h"

namespace osteon::app {

/// What the quantities that can stop a cell were held against.
struct TripLimits {
  control::ServoParams servo;
  double arm_silence_s{0.0};    ///< without a message of the arm: so long until the stop
  double arm_speed_ratio{0.0};  ///< of the tool's speed limit: what a measured tool may do for good
  /// Where a point of the arm was in a tick, in the world [m]: as commanded, with the impedance law as
  /// measured.
  std::function<Vector3(const control::TickRecord&, safety::ZonePoint)> p_WP{};
  /// Torques that gravity asks of the joints [N·m]; empty: the arm's masses or torques are not known.
  std::function<control::JointArray(const control::JointArray& q_rad)> gravity_Nm{};
};

/// The quantity that a fault is about, over the ticks around its stop, each of its panels with its limit as a
/// line. One <svg>; empty where a recording holds no such quantity (a lost device, a value that is not
/// finite): what is known of it then stands in the table of faults.
[[nodiscard]] std::string TripChart(safety::Fault fault, std::span<const control::TickRecord> ticks,
                                    const TripLimits& limits, const TimeAxis& time);

}  // namespace osteon::app
