#pragma once

namespace osteon::hil {

/// A blend from 0 to 1: its value, and its derivative with respect to the elapsed share u.
struct Blend {
  double s, slope;
};

/// s(u) = 10 u^3 - 15 u^4 + 6 u^5, u from 0 to 1. Slope and curvature are zero at both ends.
[[nodiscard]] constexpr Blend Quintic(double u) noexcept {
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u)};
}

}  // namespace osteon::hil
