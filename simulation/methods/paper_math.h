#pragma once

#include <cmath>
#include <numbers>

#include "kinematics/spatial.h"

// Equations 3 to 5 of Kaluschke et al. (IEEE VR 2019) as they are printed, errors included; cutting_math.h
// has the corrected ones. Lengths here are in millimetres, since equations 4 and 5 depend on the unit and the
// paper names none. Millimetres are assumed, as the unit with the smallest errors at a bone's scale (in
// metres, the sign of equation 4 is that of r_t - r_b).

namespace osteon::simulation::printed {

/// Equation 3: the "contact distance", which is really a fraction of the path. A root that is not positive
/// counts as no contact.
///
///     d = [ 2 (Δc·m) - sqrt(4 (m·Δc)² - 4 m² (Δc² - R²)) ] / (2 m²)
///
/// @param dc  Δc, from the tool ball's centre to the bone ball's. @param m  the tool ball's path.
/// @param R   sum of the two radii
/// @returns the fraction; or a negative number if there is no positive root up to the path's end, or the path
///   has no length. The first root of an overlapping pair is not positive, so such pairs are dropped.
[[nodiscard]] inline double ContactFraction(const Vector3& dc, const Vector3& m, double R) {
  const double mm = m.squaredNorm(), dm = dc.dot(m);
  const double discriminant = 4.0 * dm * dm - 4.0 * mm * (dc.squaredNorm() - R * R);
  if (mm <= 0.0 || discriminant < 0.0) return -1.0;
  const double d = (2.0 * dm - std::sqrt(discriminant)) / (2.0 * mm);
  return d > 0.0 && d <= 1.0 ? d : -1.0;
}

/// Equation 4, the weight V of a pair. Two squares are missing in print, so V is no volume, and it becomes
/// negative if the bone's ball is much larger than the tool's.
///
/// @param r_t, r_b  radii of the tool's and the bone's ball. @param d  distance of their centres
///
///     V = π (r_t + r_b - d) (d² + 2 d (r_t + r_b) - 3 (r_b - r_t)) / (12 d)
[[nodiscard]] inline double LensVolume(double r_t, double r_b, double d) {
  if (d <= 0.0 || d >= r_t + r_b) return 0.0;
  return std::numbers::pi * (r_t + r_b - d) * (d * d + 2.0 * d * (r_t + r_b) - 3.0 * (r_b - r_t)) /
         (12.0 * d);
}

/// Equation 5: `d_c` is the vector from the ball's centre to the closest point of the capsule's axis.
///
///     c := c - d_c / (2 |d_c|),   r := r - |d_c| / 2
///
/// The centre always moves by half a unit, whatever the depth of the cut. The nearer the ball is to the
/// capsule's axis, the less is removed. On the axis the printed equation divides by zero; here the ball stays
/// as it is.
inline void Shrink(Vector3& c, double& r, const Vector3& d_c) {
  const double distance = d_c.norm();
  if (distance <= 0.0) return;
  c -= d_c / (2.0 * distance);
  r -= 0.5 * distance;
}

}  // namespace osteon::simulation::printed
