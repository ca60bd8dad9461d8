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
  double arm_silence_s{0.0};  ///< time without a message of the arm until the stop
  /// Multiple of the tool's speed limit that a measured tool may keep indefinitely.
  double arm_speed_ratio{0.0};
  /// Computes a point of the arm in a tick, in the world [m]: as commanded or, with the impedance law, as
  /// measured.
  std::function<Vector3(const control::TickRecord&, safety::ZonePoint)> p_WP{};
  /// Computes the joint torques that hold the arm's weight [N·m]; empty: the arm's masses or torques are not
  /// known.
  std::function<control::JointArray(const control::JointArray& q_rad)> gravity_Nm{};
};

/// Plots the quantity that caused a fault over the ticks around its stop, with the limit as a line in each
/// panel. Returns one <svg>; empty if a recording has no such quantity (a lost device, a value that is not
/// finite): the known facts are then in the table of faults.
[[nodiscard]] std::string TripChart(safety::Fault fault, std::span<const control::TickRecord> ticks,
                                    const TripLimits& limits, const report::TimeAxis& time);

}  // namespace osteon::session
