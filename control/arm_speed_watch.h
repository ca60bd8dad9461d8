#pragma once

#include "control/message_gap.h"
#include "control/ports.h"
#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

struct ArmSpeedParams {
  double margin{1.5};     ///< times the tool's speed limit: what a measured tool may do for good; >= 1
  double excess_m{1e-3};  ///< way beyond that until the trip; > 0
};

/// Watches how fast the arm is measured to move the tool, whatever was commanded: an arm that jumps by itself
/// is faster than its command.
///
///     e = max(0, e + |p - p_before| - margin v_max T),   trip where e > excess_m
///
/// T is the time between the two messages on the arm's own clock: its period for each message, those that
/// were lost or overtaken on their way included, and at least the time between their arrivals. Two that
/// arrive at once are a period apart all the same, so that jitter never makes a tool fast. An encoder's noise
/// is far below margin v_max T and adds nothing.
class ArmSpeedWatch {
 public:
  /// @param period_s  of the arm's messages
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  ArmSpeedWatch(const ArmSpeedParams& params, double period_s);

  /// Once a message of an arm that the loop commands. The first one after the start or Reset() has no speed.
  /// @param p_W  apex, as measured  @param limit_m_per_s  v_max
  /// @returns true where the cell must stop.
  [[nodiscard]] bool Check(const ArmState& state, const Vector3& p_W, double limit_m_per_s) OSTEON_RT;

  /// The arm moves by itself, or is not known: the next message begins anew.
  void Reset() OSTEON_RT;

  /// Between the last two messages; 0 where there were none.
  [[nodiscard]] double speed_m_per_s() const OSTEON_RT { return speed_m_per_s_; }
  /// e
  [[nodiscard]] double excess_m() const OSTEON_RT { return excess_m_; }

 private:
  ArmSpeedParams params_;
  double period_s_;
  bool has_last_{false};
  Vector3 p_last_W_{Vector3::Zero()};
  rt::Nanoseconds stamp_{0};
  MessageGap gap_;
  double speed_m_per_s_{0.0}, excess_m_{0.0};
};

}  // namespace osteon::control
