#include "hil/loops/loop_arm.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace osteon::hil {
namespace {

// Makes an arm without speed limits, at rest with all joints at `start` [rad].
ServoArm MakeUnlimitedArm(const ServoArmParams& params, double period_s, double start) {
  std::array<kinematics::JointLimits, 7> unlimited;
  for (kinematics::JointLimits& limits : unlimited)
    limits.velocity_rad_per_s = std::numeric_limits<double>::max();
  return {params, unlimited, period_s, kinematics::JointVector::Constant(start)};
}

// Advances the arm by one period with a command. @returns position and speed of the first joint
Eigen::Vector2d StepFirstJoint(ServoArm& arm, double command) {
  arm.Step(kinematics::JointVector::Constant(command));
  return {arm.q()[0], arm.qd()[0]};
}

}  // namespace

LoopArm LinearArm(const ServoArmParams& params, double period_s) {
  const double whole = std::floor(params.dead_cycles), rest = params.dead_cycles - whole;
  ServoArmParams prompt = params;  // the arm without the whole periods of dead time
  prompt.dead_cycles = 0.0;
  // An arm starts at rest, so the speed's column is derived from a second step, at whose beginning the arm
  // moves.
  ServoArm arm = MakeUnlimitedArm(prompt, period_s, 1.0);
  const Eigen::Vector2d first = StepFirstJoint(arm, 0.0), second = StepFirstJoint(arm, 0.0);
  prompt.dead_cycles = rest;
  ServoArm at_zero = MakeUnlimitedArm(prompt, period_s, 0.0);

  LoopArm linear{.step = {}, .whole = static_cast<int>(whole), .split = rest > 0.0};
  linear.step.col(0) = first;
  linear.step.col(1) = (second - first[0] * first) / first[1];
  linear.step.col(3) = StepFirstJoint(at_zero, 1.0);
  // If an arm rests at position 1 and both commands are 1, it stays there. The column of the earlier command
  // follows from this condition.
  linear.step.col(2).setZero();
  if (linear.split) linear.step.col(2) = Eigen::Vector2d::UnitX() - first - linear.step.col(3);
  return linear;
}

HeldArm ArmHeldBy(const GridHand& hand, double felt_mass_kg, const ServoArmParams& arm) {
  if (!(felt_mass_kg > 0.0)) return {.arm = arm};
  const double w = 2.0 * std::numbers::pi * arm.bandwidth_hz;
  const double stiffness = w * w + hand.stiffness_N_per_m / felt_mass_kg;
  const double damping = 2.0 * arm.damping_ratio * w + hand.damping_Ns_per_m / felt_mass_kg;
  const double mass = 1.0 + hand.mass_kg / felt_mass_kg;
  const double w_held = std::sqrt(stiffness / mass);
  HeldArm held{.arm = arm, .command_gain = w * w / stiffness};
  held.arm.bandwidth_hz = w_held / (2.0 * std::numbers::pi);
  held.arm.damping_ratio = damping / mass / (2.0 * w_held);
  return held;
}

}  // namespace osteon::hil
