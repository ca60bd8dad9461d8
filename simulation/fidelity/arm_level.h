#pragma once

#include <cstdint>
#include <string_view>

namespace osteon::simulation {

/// How much of an arm the simulation models. Each level adds effects to the level before it.
enum class ArmFidelity : std::uint8_t {
  kKinematic,  ///< the arm is always at its commanded position
  kServo,      ///< also the lag and dead time of the position servo; no force deflects the arm
  kDynamic,    ///< also masses, friction, torque limits, impedance control, a compliant mounting
};

/// "kinematic", "servo", "dynamic": the values of a cell's simulated_arm: level.
[[nodiscard]] constexpr std::string_view ArmFidelityName(ArmFidelity level) {
  switch (level) {
    case ArmFidelity::kKinematic:
      return "kinematic";
    case ArmFidelity::kServo:
      return "servo";
    case ArmFidelity::kDynamic:
      return "dynamic";
  }
  return "unknown";
}

/// Properties of an arm and its load. ArmError computes from them how far a model of the arm is off.
struct ArmFigures {
  double bandwidth_hz{15.0}, damping_ratio{1.0};  ///< of its position servo
  double dead_time_s{0.003};
  double stiffness_N_per_m{0.0};  ///< of the arm's mounting; 0: rigid
  double feed_m_per_s{5e-3};      ///< of the tool in contact
  double force_N{100.0};          ///< contact force on the arm
};

/// Distance between the tool's position in a model of this level and on the real arm [m]:
///
///     kinematic    v (dead time + 2 z / w) + F / K
///     servo        F / K
///     dynamic      0
///
/// v is the feed, z the damping ratio, w = 2 π bandwidth, F the contact force, and K the mounting's
/// stiffness. The first term is the servo's steady lag behind a ramp, the second one the mounting's
/// deflection.
[[nodiscard]] constexpr double ArmError(ArmFidelity level, const ArmFigures& arm) {
  constexpr double kTwoPi = 6.283185307179586;
  const double give_m = arm.stiffness_N_per_m > 0.0 ? arm.force_N / arm.stiffness_N_per_m : 0.0;
  const double lag_s = arm.dead_time_s + 2.0 * arm.damping_ratio / (kTwoPi * arm.bandwidth_hz);
  switch (level) {
    case ArmFidelity::kKinematic:
      return arm.feed_m_per_s * lag_s + give_m;
    case ArmFidelity::kServo:
      return give_m;
    case ArmFidelity::kDynamic:
      return 0.0;
  }
  return 0.0;
}

/// The lowest level whose error is at most `error_m`.
[[nodiscard]] constexpr ArmFidelity LowestArmLevel(const ArmFigures& arm, double error_m) {
  for (const ArmFidelity level : {ArmFidelity::kKinematic, ArmFidelity::kServo})
    if (ArmError(level, arm) <= error_m) return level;
  return ArmFidelity::kDynamic;
}

}  // namespace osteon::simulation
