#pragma once

#include <cmath>
#include <limits>

#include "base/marker.h"
#include "kinematics/spatial.h"

// Bounds on energy and power, which are applied as bounds on force and speed. Infinite: no bound.

namespace osteon::safety {

struct EnergyLimitParams {
  /// energy stored in the coupling's spring; > 0
  double max_stored_J{std::numeric_limits<double>::infinity()};
  double max_power_W{std::numeric_limits<double>::infinity()};  ///< power from the coupling to the hand; > 0
  double max_kinetic_J{std::numeric_limits<double>::infinity()};  ///< kinetic energy of the moving tool; > 0
  /// Mass that a hand would feel if the moving tool hit it, including the arm's inertia at the tool; > 0.
  double moving_mass_kg{10.0};
};

/// Checks the parameters. @throws std::invalid_argument naming the field, the value and what is accepted.
void Validate(const EnergyLimitParams& params);

/// Force at which a spring stores this energy: f^2 / 2K = E.
[[nodiscard]] inline double ForceOfEnergy(double energy_J, double stiffness_N_per_m) OSTEON_RT {
  return std::sqrt(2.0 * stiffness_N_per_m * energy_J);
}

/// Speed at which a mass has this energy: m v^2 / 2 = E.
[[nodiscard]] inline double SpeedOfEnergy(double energy_J, double mass_kg) OSTEON_RT {
  return std::sqrt(2.0 * energy_J / mass_kg);
}

/// Largest share 0 … 1 of a wrench on the tool whose power at this twist is at most max_power_W; 1 for a
/// wrench that takes energy from the motion. @param F_T, V_T  wrench and twist of the same point, in the same
/// axes
[[nodiscard]] inline double PowerScale(const Wrench& F_T, const Twist& V_T, double max_power_W) OSTEON_RT {
  const double power_W = F_T.f.dot(V_T.v) + F_T.t.dot(V_T.w);
  return power_W > max_power_W ? max_power_W / power_W : 1.0;
}

/// PowerScale for a wrench that causes a part of the motion, as in an admittance law. The share s of such a
/// wrench has the power s (p_0 + s (p_1 - p_0)).
/// @param power_without_W  p_0: power of the whole wrench on the motion that happens without the wrench
/// @param power_with_W  p_1 >= p_0: power of the whole wrench on the motion that happens with the whole
/// wrench
[[nodiscard]] inline double PowerScale(double power_without_W, double power_with_W,
                                       double max_power_W) OSTEON_RT {
  if (!(power_with_W > max_power_W)) return 1.0;
  // the positive root s of s (p_0 + s (p_1 - p_0)) = max
  const double own_W = power_with_W - power_without_W;
  const double root_W = std::sqrt(power_without_W * power_without_W + 4.0 * own_W * max_power_W);
  return 2.0 * max_power_W / (power_without_W + root_W);
}

}  // namespace osteon::safety
