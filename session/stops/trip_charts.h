#pragma once

#include <functional>
#include <span>
#include <string>

#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "control/tick_record.h"
#include "report/time_axis.h"
#include "safety/fault.h"
#include "safety/zone.h"

namespace osteon::session {

/// The limits that can stop a cell, and the functions that their charts need.
struct TripLimits {
  control::ServoParams servo;
  double arm_silence_s{0.0};  ///< age of the arm's last message at which the loop stops
  /// Ratio to the tool's speed limit up to which the measured tool speed never trips.
  double arm_speed_ratio{0.0};
  /// Computes the position of apex, flange or elbow in a tick, in the world [m]: the commanded position or,
  /// under the impedance law, the measured one.
  std::function<Vector3(const control::TickRecord&, safety::ZonePoint)> p_WP{};
  /// Computes the joint torques that hold the arm's weight [N·m]; empty: the arm's masses or torques are not
  /// known.
  std::function<control::JointArray(const control::JointArray& q_rad)> gravity_Nm{};
};

/// Plots the quantity that caused a fault over the ticks around its stop, with the limit as a line in each
/// panel. Returns one <svg>; empty if the recording has no such quantity (a lost device, a value that is not
/// finite). The table of faults then says what is known.
[[nodiscard]] std::string TripChart(safety::Fault fault, std::span<const control::TickRecord> ticks,
                                    const TripLimits& limits, const report::TimeAxis& time);

}  // namespace osteon::session
