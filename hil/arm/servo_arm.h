#pragma once

#include <array>
#include <limits>

#include "base/marker.h"
#include "kinematics/lbr_arm.h"

namespace osteon::hil {

/// Parameters of the simulated arm's lag. The values are assumptions and should be varied: the lag of no real
/// arm was measured.
struct ServoArmParams {
  double bandwidth_hz{15.0};  ///< natural frequency of each joint
  double damping_ratio{1.0};  ///< z
  /// Number of periods from a command to its first effect, not necessarily whole, 0 …
  /// ServoArm::kMaxDeadCycles.
  double dead_cycles{3.0};
  /// Bound on |q''|; none by default. The accelerations published for the iiwa are limits for planned
  /// motions, far below what its drives can do. A servo that saturates at them would not be the linear arm
  /// for which the stability results were computed.
  double max_acceleration_rad_per_s2{std::numeric_limits<double>::infinity()};
};

/// An arm in position mode. Each joint is a servo with lag and dead time (the arm of Model B in control.md):
///
///     q'' = w^2 (q_cmd[k - dead] - q) - 2 z w q',   w = 2 pi bandwidth_hz
///
/// With a dead time of n + f periods, 0 < f < 1, each period k has two parts: q_cmd[k - n - 1] acts for the
/// fraction f of the period, then q_cmd[k - n] acts. Between two steps the command is constant (zero-order
/// hold), so the equation's closed-form solution advances the state. It is exact except for rounding, for any
/// period, while no limit acts. If |q'| or |q''| would exceed its limit, the step uses a constant
/// acceleration that respects both limits. Forces on the tool do not deflect the arm. Deterministic, does not
/// allocate.
class ServoArm {
 public:
  static constexpr int kMaxDeadCycles = 32;

  /// Starts at rest at q_start [rad]. Only the velocity limits are used.
  /// @throws std::invalid_argument on a parameter out of range.
  ServoArm(const ServoArmParams& params, const std::array<kinematics::JointLimits, 7>& limits,
           double period_s, const kinematics::JointVector& q_start);

  /// Advances by one period with the command given at its beginning.
  void Step(const kinematics::JointVector& q_cmd) OSTEON_RT;

  [[nodiscard]] const kinematics::JointVector& q() const OSTEON_RT { return q_; }    ///< [rad]
  [[nodiscard]] const kinematics::JointVector& qd() const OSTEON_RT { return qd_; }  ///< [rad/s]

 private:
  // A part of a period in which one command acts.
  struct Part {
    double duration_s{0.0};
    // transition matrix of (q - q_cmd, q') over the part
    Eigen::Matrix2d transition{Eigen::Matrix2d::Identity()};
  };
  // Advances all joints by this part of a period toward the target, within the limits.
  void Advance(const Part& part, const kinematics::JointVector& target) OSTEON_RT;

  double max_acceleration_rad_per_s2_;
  kinematics::JointVector max_speed_rad_per_s_;
  Part first_, second_;  // second_ has no duration if the dead time is a whole number of periods
  kinematics::JointVector q_, qd_;
  std::array<kinematics::JointVector, kMaxDeadCycles + 1> delay_;  // ring of commands; next_ is the oldest
  std::size_t delay_size_{1}, next_{0};
};

}  // namespace osteon::hil
