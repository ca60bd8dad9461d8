#pragma once

#include "base/marker.h"
#include "control/arm/message_gap.h"
#include "control/ports.h"
#include "kinematics/spatial.h"

namespace osteon::control {

struct ArmSpeedParams {
  double margin{1.5};     ///< the measured tool may move at margin × speed limit for any time; >= 1
  double excess_m{1e-3};  ///< largest excess distance e without a trip; > 0
};

/// Monitors the measured speed of the tool, independently of the command: an arm that jumps by itself is
/// faster than its command.
///
///     e = max(0, e + |p - p_before| - margin v_max T),   trip if e > excess_m
///
/// p is the apex's position in a message, p_before that in the previous message, and v_max the speed limit. T
/// is the time between the two messages: the larger of the time between their arrivals, and one period for
/// each message, including those that were lost, or overtaken by a newer message before they were read. Two
/// messages that arrive together count as one period apart, so jitter never makes the tool look fast. Encoder
/// noise is far below margin v_max T and adds nothing to e.
class ArmSpeedWatch {
 public:
  /// @param period_s  of the arm's messages
  /// @throws std::invalid_argument naming the parameter, the value and what is accepted.
  ArmSpeedWatch(const ArmSpeedParams& params, double period_s);

  /// Checks one message of an arm that the loop commands. The first message after construction or Reset()
  /// only stores the position.
  /// @param p_W  apex, as measured  @param limit_m_per_s  v_max
  /// @returns true if the cell must stop.
  [[nodiscard]] bool Check(const ArmState& state, const Vector3& p_W, double limit_m_per_s) OSTEON_RT;

  /// Call while the arm moves by itself or its position is unknown. The check begins anew with the next
  /// message.
  void Reset() OSTEON_RT;

  /// Speed between the last two messages; 0 if there were no two messages.
  [[nodiscard]] double speed_m_per_s() const OSTEON_RT { return speed_m_per_s_; }
  /// Excess distance e.
  [[nodiscard]] double excess_m() const OSTEON_RT { return excess_m_; }

 private:
  ArmSpeedParams params_;
  double period_s_;
  bool has_last_{false};  // a message came since Reset(): the two members below are its values
  Vector3 p_last_W_{Vector3::Zero()};
  rt::Nanoseconds stamp_{0};  // arrival of the last message
  MessageGap gap_;
  double speed_m_per_s_{0.0}, excess_m_{0.0};
};

}  // namespace osteon::control
