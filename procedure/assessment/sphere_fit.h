#pragma once

#include <span>
#include <string>

#include <tl/expected.hpp>

#include "base/units.h"
#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"

namespace osteon::procedure {

/// The sphere that a reamer left, fitted to the balls that it cut.
struct SphereFit {
  Vector3 centre_m{Vector3::Zero()};
  double radius_m{0.0};
  double cap_rad{0.0};  ///< angle of the cap that the balls cover: the largest angle, at the sphere's centre,
                        ///< between the cavity's pole and a ball's nearest point
  std::size_t balls{0};       ///< number of balls that were fitted
  double residual_sd_m{0.0};  ///< RMS of the residuals |c_i - C| - r_i - R
  /// 95th percentile of the residuals' magnitude, a measure of the deviation from a sphere
  double residual_p95_m{0.0};
  double radius_sd_m{0.0};  ///< standard deviation of the radius
  double depth_sd_m{0.0};   ///< standard deviation of the centre along the axis
};

/// No sphere is fitted to a cap with a smaller angle, because such a cap hardly determines radius and depth
/// separately.
inline constexpr double kMinCap_rad = 45.0 * kDegree;

/// Fits centre C and radius R to cut balls, by Gauss-Newton:
///
///     minimise sum (|c_i - C| - r_i - R)²
///
/// A cut ball touches the tool's sweep, so its point nearest to C lies on the reamed surface. (Sampling the
/// union of balls by rays would also hit the valleys between the balls and give a larger sphere.) Balls whose
/// nearest point is above the centre, towards the opening, touch the cylinder that the tool swept on its way
/// in, and are left out.
///
/// With cap angle t, c = cos t, residual s and N balls, for points spread evenly over the cap:
///
///     sd(R) = s / sqrt(N) sqrt(1 + 3 ((1 + c) / (1 - c))²)      sd(depth) = s sqrt(12) / (sqrt(N) (1 - c))
///
/// @param axis  unit, out of the opening
/// @param near_centre_m, near_radius_m  start values of the fit: those of the plan
/// @returns the sphere, or why there is none: too few balls, a cap below 45°, or no convergence.
[[nodiscard]] tl::expected<SphereFit, std::string> FitSphere(std::span<const simulation::Ball> cut_balls,
                                                             const Vector3& axis,
                                                             const Vector3& near_centre_m,
                                                             double near_radius_m);

}  // namespace osteon::procedure
