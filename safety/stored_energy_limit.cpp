#include "safety/stored_energy_limit.h"

#include <algorithm>
#include <cmath>

namespace osteon::safety {

double StoredEnergyLimit::Step(double displacement_m, double energy_J) OSTEON_RT {
  if (!std::isfinite(max_stored_J_)) return 1.0;
  if (!(displacement_m > 0.0 && energy_J > 0.0)) {
    slip_m_ = 0.0;
    return 1.0;
  }
  // E_spring = k d^2 / 2, so that d_E = d sqrt(E / E_spring)
  const double bound_m = displacement_m * std::sqrt(max_stored_J_ / energy_J);
  slip_m_ = std::clamp(slip_m_, std::max(0.0, displacement_m - bound_m), displacement_m);
  return (displacement_m - slip_m_) / displacement_m;
}

}  // namespace osteon::safety
