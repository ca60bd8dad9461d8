#pragma once

#include <cmath>
#include <numbers>

#include "kinematics/spatial.h"

// Equations 3 to 5 of Kaluschke et al. (IEEE VR 2019) as they are printed, errors included; cutting_math.h
// has the corrected ones. Lengths here are in millimetres, since equations 4 and 5 depend on the unit and the
// paper names none. The unit is assumed as the one that does least harm at a bone's scale (in metres,
// equation 4 has the sign of r_t - r_b alone).

namespace osteon::simulation::printed {

/// Equation 3: the "contact distance", which is a fraction of the path. A root that is not positive is no
/// contact.
///
///     d = [ 2 (Δc·m) - sqrt(4 (m·Δc)² - 4 m² (Δc² - R²)) ] / (2 m²)
///
/// @param dc  Δc, from the tool ball's centre to the bone ball's. @param m  the tool ball's path.
/// @param R   sum of the two radii
/// @returns the fraction, or a negative number where there is no positive root up to the path's end, or no
///   path to divide by. Pairs that overlap have no positive first root and are dropped.
[[nodiscard]] inline double ContactFraction(const Vector3& dc, const Vector3& m, double R) {
  const double mm = m.squaredNorm(), dm = dc.dot(m);
  const double discriminant = 4.0 * dm * dm - 4.0 * mm * (dc.squaredNorm() - R * R);
  if (mm <= 0.0 || discriminant < 0.0) return -1.0;
  const double d = (2.0 * dm - std::sqrt(discriminant)) / (2.0 * mm);
  return d > 0.0 && d <= 1.0 ? d : -1.0;
}

/// Equation 4: two squares are missing in print, so it is no volume, and it is negative where the bone's ball
/// is much larger than the tool's.
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
/// The centre moves by half a unit whatever the cut. The nearer the ball is to the tool's axis, the less is
/// removed; on the axis itself nothing is (there the print divides by zero).
inline void Shrink(Vector3& c, double& r, const Vector3& d_c) {
  const double distance = d_c.norm();
  if (distance <= 0.0) return;
  c -= d_c / (2.0 * distance);
  r -= 0.5 * distance;
}

}  // namespace osteon::simulation::printed
