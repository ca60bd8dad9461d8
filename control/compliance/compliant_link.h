#pragma once

#include <Eigen/Core>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Order of rows and columns: translation x, y, z, then rotation x, y, z; or force, then torque.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// One tick of a massless Kelvin-Voigt element, a spring and a damper in parallel. x is its displacement, T
/// the period, tau its time constant:
///
///     x+ = (x + (T/tau) x_inf(F)) / (1 + T/tau)
///
/// x_inf(F) is the displacement at rest under the force F. Let x_inf = C F, with the force F of a contact
/// spring K in series, and let c be the element's largest compliance at a touching point. Then the element
/// dissipates energy over every closed path, and is stable, if and only if tau >= T (K c - 1) / 2. Source:
/// implicit Euler of tau x' + x = x_inf.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 1> StepMassless(const Eigen::Matrix<double, N, 1>& x,
                                                       const Eigen::Matrix<double, N, 1>& x_inf,
                                                       double period_s, double tau_s) OSTEON_RT {
  const double ratio = period_s / tau_s;
  return (x + ratio * x_inf) / (1.0 + ratio);
}

/// A tool that bends: a massless element between the rigid tool's frame T and its bent head E. Every field
/// but the compliance has a usable default.
struct ToolLinkParams {
  Matrix6 compliance_T{Matrix6::Zero()};  ///< maps a wrench on E (at Eo, in T) to the displacement of E in T
  double tau_s{0.020};                    ///< time constant; > 0
  double max_bend_m{0.01};   ///< larger lateral displacement stops the cell (free length / 10); > 0
  double max_thrust_N{1e3};  ///< larger axial thrust stops the cell (half of the buckling load); > 0
};

/// Pose of the bent head in T: exponential of the element's displacement e.
[[nodiscard]] Pose BentHead(const Vector6& e) OSTEON_RT;

/// @throws std::invalid_argument naming the field, the value found and what is accepted: a symmetric
///   compliance without negative eigenvalues.
void Validate(const ToolLinkParams& params);

}  // namespace osteon::control
