#pragma once

#include <cmath>

#include <Eigen/Core>

namespace osteon::hil {

/// Transition matrix of the state (e, e') over a time T, for e'' = -w^2 e - 2 z w e'. With a = z w and
/// s^2 = a^2 - w^2 (negative if the motion oscillates; C and S are then cos and sin terms), C = cosh(s T) and
/// S = sinh(s T) / s:
///
///     exp(A T) = e^(-a T) [C + a S, S; -w^2 S, C - a S]
///
/// @param w  [rad/s], > 0   @param z  damping ratio, >= 0   @param time_s  >= 0
[[nodiscard]] inline Eigen::Matrix2d SecondOrderStep(double w, double z, double time_s) {
  const double a = z * w, s2 = a * a - w * w, s = std::sqrt(std::abs(s2));
  double C = 1.0, S = time_s;  // the limit s -> 0, at z = 1
  if (s * time_s > 1e-9) {
    C = s2 > 0.0 ? std::cosh(s * time_s) : std::cos(s * time_s);
    S = (s2 > 0.0 ? std::sinh(s * time_s) : std::sin(s * time_s)) / s;
  }
  Eigen::Matrix2d M;
  M << C + a * S, S, -w * w * S, C - a * S;
  return std::exp(-a * time_s) * M;
}

}  // namespace osteon::hil
