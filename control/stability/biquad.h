#pragma once

#include <cmath>
#include <numbers>

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// A second-order filter of vectors, by component. Its initial state is that of an input that has always been
/// zero.
///
///     y = b0 x + s1,   s1' = b1 x - a1 y + s2,   s2' = b2 x - a2 y        (transposed direct form II)
class Biquad {
 public:
  /// One stage of a Butterworth filter. `q` is the quality factor of its pole pair (2nd-order filter: 1/sqrt
  /// 2; 4th-order filter, two stages: 0.5412 and 1.3066). Pre-warping keeps the edge frequency exact.
  /// @param edge_hz  between 0 and half the sampling rate, both excluded
  [[nodiscard]] static Biquad LowPass(double edge_hz, double q, double period_s) {
    const Prototype p(edge_hz, q, period_s);
    return {p.k2 / p.a0, 2.0 * p.k2 / p.a0, p.k2 / p.a0, p};
  }
  /// As LowPass, but passes the frequencies above the edge.
  [[nodiscard]] static Biquad HighPass(double edge_hz, double q, double period_s) {
    const Prototype p(edge_hz, q, period_s);
    return {1.0 / p.a0, -2.0 / p.a0, 1.0 / p.a0, p};
  }

  /// Filters the next sample x. @returns y
  [[nodiscard]] Vector3 Step(const Vector3& x) OSTEON_RT {
    const Vector3 y = b0_ * x + s1_;
    s1_ = b1_ * x - a1_ * y + s2_;
    s2_ = b2_ * x - a2_ * y;
    return y;
  }

 private:
  // Values that low pass and high pass share: k2 = tan²(pi edge period), and the denominator's coefficients,
  // with a1 and a2 divided by a0.
  struct Prototype {
    Prototype(double edge_hz, double q, double period_s) {
      const double k = std::tan(std::numbers::pi * edge_hz * period_s);
      k2 = k * k;
      a0 = 1.0 + k / q + k2;
      a1 = 2.0 * (k2 - 1.0) / a0;
      a2 = (1.0 - k / q + k2) / a0;
    }
    double k2, a0, a1, a2;
  };
  Biquad(double b0, double b1, double b2, const Prototype& p)
      : b0_(b0), b1_(b1), b2_(b2), a1_(p.a1), a2_(p.a2) {}

  double b0_, b1_, b2_, a1_, a2_;
  Vector3 s1_{Vector3::Zero()}, s2_{Vector3::Zero()};
};

}  // namespace osteon::control
