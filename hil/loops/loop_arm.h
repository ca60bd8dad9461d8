#pragma once

#include <Eigen/Dense>

#include "hil/arm/servo_arm.h"
#include "hil/operator/hand_grid.h"

// The simulated arm as a part of a linear loop.

namespace osteon::hil {

/// One axis of the shipped ServoArm, within its limits, for a loop that is a matrix.
///
/// A command is sent in the tick that computes it: a dead time of 0 means that it acts from that tick on.
struct LoopArm {
  /// (x, x')+ = step (x, x', command before, command): the commands that act in the first and in the second
  /// part of the period. With a dead time of whole periods only the last one acts.
  Eigen::Matrix<double, 2, 4> step;
  int whole{0};       ///< whole periods of the dead time
  bool split{false};  ///< whether a part of a period is left

  /// Commands of earlier ticks that a loop has to keep.
  [[nodiscard]] int history() const { return whole + (split ? 1 : 0); }
};

/// @throws std::invalid_argument on a parameter out of range.
[[nodiscard]] LoopArm LinearArm(const ServoArmParams& params, double period_s);

/// An arm that the hand's force moves aside, as an arm with other figures.
struct HeldArm {
  ServoArmParams arm;
  double command_gain{1.0};  ///< ratio of the arm's position at rest to its command
};

/// The arm with a hand at it, whose force moves it as if it had the mass felt_mass_kg:
///
///     x'' = w^2 (x_c - x) - 2 z w x' - (k x + b x' + m x'') / M
///
/// is an arm of w_h^2 = (w^2 + k/M) / (1 + m/M), 2 z_h w_h = (2 z w + b/M) / (1 + m/M), whose command is
/// w^2 / (w^2 + k/M) x_c.
/// @param felt_mass_kg  M; 0: the hand does not move the arm
[[nodiscard]] HeldArm ArmHeldBy(const GridHand& hand, double felt_mass_kg, const ServoArmParams& arm);

}  // namespace osteon::hil
