#pragma once

#include <array>
#include <limits>

#include "base/marker.h"
#include "kinematics/lbr_arm.h"

namespace osteon::hil {

/// How the simulated arm follows its commands. The values are assumptions, to be varied: no real arm's lag
/// was measured.
struct ServoArmParams {
  double bandwidth_hz{15.0};  ///< natural frequency of each joint
  double damping_ratio{1.0};  ///< z
  /// Periods from a command to its first effect, whole or not, 0 … ServoArm::kMaxDeadCycles.
  double dead_cycles{3.0};
  /// Bound on |q''|. None by default: the figures published for the iiwa are planning limits, far below what
  /// its drives can do, and a saturating servo is not the arm that the stability rows were computed for.
  double max_acceleration_rad_per_s2{std::numeric_limits<double>::infinity()};
};

/// An arm in position mode, joint by joint a servo with lag and dead time (the arm of control.md's Model B):
///
///     q'' = w^2 (q_cmd[k - dead] - q) - 2 z w q',   w = 2 pi bandwidth_hz
///
/// A dead time of n + f periods, 0 < f < 1, advances in two parts: q_cmd[k - n - 1] acts for f of the period,
/// then q_cmd[k - n].
/// Between two steps the command is constant (zero-order hold), so the equation's closed-form solution
/// advances the state: exact to rounding for any period while no limit acts. If |q'| or |q''| would pass its
/// limit, the step uses the constant acceleration that keeps the limit. Forces on the tool do not deflect the
/// arm. Deterministic, does not allocate.
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
  // A stretch of a period in which one command acts.
  struct Part {
    double duration_s{0.0};
    Eigen::Matrix2d transition{Eigen::Matrix2d::Identity()};  // matrix for (q - q_cmd, q')
  };
  // Advances all joints by this part of a period toward the target, within the limits.
  void Advance(const Part& part, const kinematics::JointVector& target) OSTEON_RT;

  double max_acceleration_rad_per_s2_;
  kinematics::JointVector max_speed_rad_per_s_;
  Part first_, second_;  // second_ has no duration where the dead time is whole
  kinematics::JointVector q_, qd_;
  std::array<kinematics::JointVector, kMaxDeadCycles + 1> delay_;  // commands, oldest at next_
  std::size_t delay_size_{1}, next_{0};
};

}  // namespace osteon::hil
