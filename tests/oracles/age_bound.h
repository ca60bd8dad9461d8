#pragma once

#include <Eigen/Dense>

// The exact bound of docs/theory/stability.md for a force whose age varies: an oracle for loops whose forces
// have such ages.

namespace osteon::hil {

/// The damping in excess of that which guarantees stability for any age up to max_age_s. For the loop M x'' +
/// D x' + K x(t - a(t)) = 0 with M, D, K symmetric, K >= 0 and 0 <= a(t) <= max_age_s, which may vary
/// arbitrarily (delay, hold, jitter, drop-outs):
///
///     D - a_max K > 0   is sufficient, for any M
///
/// K is the stiffness whose force has the age a. If the loop evaluates planes in each tick, only the planes'
/// own motion is old; K is then the change of force with this motion.
/// @returns the smallest eigenvalue of D - a_max K [N s/m]; > 0: stable.
[[nodiscard]] inline double AgeReserve(const Eigen::Matrix<double, 6, 6>& D,
                                       const Eigen::Matrix<double, 6, 6>& K, double max_age_s) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(D - max_age_s * K, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// The same bound for one contact at a lever L from the centre of rotation, with damping b along the
/// contact's normal and b_r about the centre:
///
///     k_max = 1 / (a (1/b + L^2/b_r))
///
/// @returns the largest stiffness of the contact [N/m] for which the bound holds. Choose b_r >= b L^2.
[[nodiscard]] inline double LeverStiffness(double lever_m, double damping_Ns_per_m,
                                           double damping_Nms_per_rad, double max_age_s) {
  return 1.0 / (max_age_s * (1.0 / damping_Ns_per_m + lever_m * lever_m / damping_Nms_per_rad));
}

}  // namespace osteon::hil
