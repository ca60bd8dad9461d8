#pragma once

#include <algorithm>

namespace osteon::studies {

/// A mass with drag that a hand pushes along a line: the virtual tool of an admittance law, or the arm under
/// an impedance law.
struct Carrier {
  double mass_kg{3.0}, damping_Ns_per_m{100.0};
  double way_m{0.0}, v_m_per_s{0.0};

  /// One period, semi-implicit. @param force_N  of all that pushes it along the line
  void Step(double force_N, double dt_s) {
    v_m_per_s += dt_s * (force_N - damping_Ns_per_m * v_m_per_s) / mass_kg;
    way_m += dt_s * v_m_per_s;
  }
};

/// A push that rises from zero to its full force.
[[nodiscard]] inline double RisingPush(double full_N, double time_s, double rise_s) {
  return full_N * std::min(1.0, time_s / rise_s);
}

}  // namespace osteon::studies
