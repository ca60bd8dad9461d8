#pragma once

#include <Eigen/Dense>

// The exact bound of docs/theory/stability.md for a force whose age varies: an oracle of loops with such
// ages.

namespace osteon::hil {

/// Damping that keeps the loop stable for any age up to max_age_s. For M x'' + D x' + K x(t - a(t)) = 0 with
/// M, D, K symmetric, K >= 0 and 0 <= a(t) <= max_age_s, which may vary arbitrarily (delay, hold, jitter,
/// drop-outs):
///
///     D - a_max K > 0   is sufficient, for any M
///
/// K is the stiffness that acts with this age. If planes are evaluated in the tick, it is only the stiffness
/// by which the planes themselves move.
/// @returns the smallest eigenvalue of D - a_max K [N s/m]; > 0: stable.
[[nodiscard]] inline double AgeReserve(const Eigen::Matrix<double, 6, 6>& D,
                                       const Eigen::Matrix<double, 6, 6>& K, double max_age_s) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(D - max_age_s * K, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// The same for one contact at a lever, with damping b along it and b_r about the centre of rotation:
///
///     k_max = 1 / (a (1/b + L^2/b_r))
///
/// @returns the largest stiffness of the contact [N/m] for which the bound holds. Choose b_r >= b L^2.
[[nodiscard]] inline double LeverStiffness(double lever_m, double damping_Ns_per_m,
                                           double damping_Nms_per_rad, double max_age_s) {
  return 1.0 / (max_age_s * (1.0 / damping_Ns_per_m + lever_m * lever_m / damping_Nms_per_rad));
}

}  // namespace osteon::hil
