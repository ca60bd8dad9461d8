#pragma once

#include <Eigen/Dense>

#include "hil/arm/servo_arm.h"
#include "hil/operator/hand_grid.h"

// The simulated arm as a part of a linear loop.

namespace osteon::hil {

/// One axis of ServoArm as a matrix, valid while no limit acts.
///
/// A command is sent in the tick that computes it. With a dead time of 0 it acts from that tick on.
struct LoopArm {
  /// (x, x')+ = step (x, x', earlier command, command). The earlier command acts in the first part of the
  /// period, the other in the second part. If the dead time is a whole number of periods, only the last
  /// command acts.
  Eigen::Matrix<double, 2, 4> step;
  int whole{0};       ///< whole periods of the dead time
  bool split{false};  ///< whether the dead time has a fraction of a period in addition

  /// Number of earlier ticks whose commands the loop must store.
  [[nodiscard]] int history() const { return whole + (split ? 1 : 0); }
};

/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] LoopArm LinearArm(const ServoArmParams& params, double period_s);

/// An arm that yields to the hand's force, expressed as an arm with other parameters.
struct HeldArm {
  ServoArmParams arm;
  double command_gain{1.0};  ///< ratio of the arm's position at rest to its command
};

/// Returns the parameters of an arm that a hand (k, b, m) holds. The hand's force moves the arm as if the arm
/// had the mass M:
///
///     x'' = w^2 (x_c - x) - 2 z w x' - (k x + b x' + m x'') / M
///
/// This equation describes an arm with w_h^2 = (w^2 + k/M) / (1 + m/M), 2 z_h w_h = (2 z w + b/M) / (1 + m/M)
/// and the command w^2 / (w^2 + k/M) x_c.
/// @param felt_mass_kg  M; 0: the hand does not move the arm
[[nodiscard]] HeldArm ArmHeldBy(const GridHand& hand, double felt_mass_kg, const ServoArmParams& arm);

}  // namespace osteon::hil
