#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinematics/spatial.h"
#include "simulation/contact/cutting_constants.h"

// The formulas of the cutting model for single pairs, in double precision. The shaders have the same
// functions (gpu/shaders: exact.glsl, near_field.comp, remove_clear.comp). Source: Kaluschke et al., IEEE VR
// 2019, equations 3 to 5, corrected; each function names its correction.

namespace osteon::simulation {

/// The value that means "no contact on the path". It is larger than any fraction.
inline constexpr double kNoContact = 2.0;

/// Rounds a matrix to floats, the precision that a GPU gets, and returns it in double precision. The float is
/// volatile because GCC 12 otherwise drops both conversions where it vectorises the product that follows,
/// from -O2 on with Eigen's cast<float>().cast<double>(), at -O3 with a plain loop as well.
[[nodiscard]] inline Matrix3 RoundToFloat(const Matrix3& m) {
  Matrix3 rounded;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) {
      const volatile float value = static_cast<float>(m(row, column));
      rounded(row, column) = static_cast<double>(value);
    }
  return rounded;
}

/// Pass 1. Fraction of a tool ball's path at which it first touches a bone ball (equation 3).
///
///     s = [ D·m - sqrt((D·m)^2 - m^2 (D^2 - R^2)) ] / m^2
///
/// written without its cancellation: s = (D^2 - R^2) / (D·m + sqrt(...)).
/// @param D  from the tool ball's centre at the start of the path to the bone ball's centre
/// @param m  the tool ball's path
/// @param R  sum of both radii
/// @returns s in [0, 1], or kNoContact. If the balls overlap already: 0 if the path leads inwards (D·m > 0),
/// kNoContact if it leads out. The paper takes positive roots only and so ignores every overlapping pair,
/// which lets the tool tunnel through bone.
[[nodiscard]] inline double FirstContactFraction(const Vector3& D, const Vector3& m, double R) {
  const double Dm = D.dot(m);
  if (Dm <= 0.0) return kNoContact;  // the tool ball moves away, or does not move
  const double gap = D.squaredNorm() - R * R;
  if (gap <= 0.0) return 0.0;
  const double discriminant = Dm * Dm - m.squaredNorm() * gap;
  if (discriminant < 0.0) return kNoContact;
  const double s = gap / (Dm + std::sqrt(discriminant));
  return s <= 1.0 ? s : kNoContact;
}

/// Pass 2. Volume that two balls share (equation 4 of the paper, corrected by two squares that are missing
/// there); r1, r2: radii, d: distance of the centres.
///
///     V = pi (r1+r2-d)^2 (d^2 + 2d(r1+r2) - 3(r1-r2)^2) / (12 d)     |r1-r2| < d < r1+r2
///     V = 4/3 pi min(r1,r2)^3 for d <= |r1-r2| ;  0 for d >= r1+r2
[[nodiscard]] inline double LensVolume(double r1, double r2, double d) {
  if (d >= r1 + r2) return 0.0;
  const double dr = r1 - r2;
  if (d <= std::abs(dr)) return 4.0 / 3.0 * std::numbers::pi * std::pow(std::min(r1, r2), 3);
  const double over = r1 + r2 - d;
  return std::numbers::pi * over * over * (d * d + 2.0 * d * (r1 + r2) - 3.0 * dr * dr) / (12.0 * d);
}

/// Closest point to p on the segment from a to b.
[[nodiscard]] inline Vector3 ClosestOnSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 m = b - a;
  const double mm = m.squaredNorm();
  if (mm == 0.0) return a;
  return a + std::clamp((p - a).dot(m) / mm, 0.0, 1.0) * m;
}

/// Pass 3. Shrinks a bone ball to the largest ball inside it and outside a capsule (equation 5, with the
/// vector read as the penetration; as printed, its units do not agree).
///
///     p = r_b + r_t - |c_b - q| ;   p >= 2 r_b: gone ;   else  c_b += u p/2,  r_b -= p/2
///
/// with p the penetration, r_b and c_b radius and centre of the bone ball, q the closest point of the
/// capsule's axis to c_b, and u the unit vector from q to c_b. If c_b is on the axis, any perpendicular
/// direction is valid, and a fixed one is taken. The new centre c' and radius r' fulfil |c' - c| = r - r', so
/// the new ball lies inside the old one.
/// @param c, r  the bone ball; r = 0: gone
/// @param a, b  ends of the capsule's axis @param r_t  the capsule's radius
/// @returns whether the ball changed.
inline bool ShrinkBall(Vector3& c, double& r, const Vector3& a, const Vector3& b, double r_t) {
  const Vector3 q = ClosestOnSegment(c, a, b);
  const Vector3 away = c - q;
  const double distance = away.norm();
  const double p = r + r_t - distance;
  if (r <= 0.0 || p <= 0.0) return false;
  if (p >= 2.0 * r || r - 0.5 * p < kMinBallRadius) {
    r = 0.0;
    return true;
  }
  Vector3 u = away;
  const Vector3 m = b - a;
  const double mm = m.squaredNorm(), along = (c - a).dot(m);
  // For a centre beside the axis, u is perpendicular to the axis. So close to the axis, rounding leaves a
  // component along it: remove this component.
  if (distance < kOnAxis * r_t && along > 0.0 && along < mm) u -= u.dot(m) / mm * m;
  if (u.norm() > kOnAxis * distance) {
    u.normalize();
  } else {
    // The centre is on the axis: take the coordinate axis with the smallest component along the segment, and
    // make it perpendicular to the segment.
    const Vector3 pick = std::abs(m.x()) <= std::abs(m.y()) && std::abs(m.x()) <= std::abs(m.z())
                             ? Vector3::UnitX()
                         : std::abs(m.y()) <= std::abs(m.z()) ? Vector3::UnitY()
                                                              : Vector3::UnitZ();
    u = (mm > 0.0 ? Vector3(pick - pick.dot(m) / mm * m) : pick).normalized();
  }
  c += 0.5 * p * u;
  r -= 0.5 * p;
  return true;
}

}  // namespace osteon::simulation
