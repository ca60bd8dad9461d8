#pragma once

#include <array>

#include "control/rt/marker.h"
#include "kinematics/chain_params.h"

// Preferences of the posture, as joint velocities whose part in the null space a differential inverse follows
// (MotionInput::qd_null). They add up.

namespace osteon::kinematics {

struct PosturePreferenceParams {
  double limit_zone_rad{0.35};        ///< of a joint's range at either end: from here on it is led back; > 0
  double limit_speed_rad_per_s{0.3};  ///< at the limit itself; >= 0
  double singular_zone_m{0.07};       ///< smallest singular values below this are led up; > 0
  double singular_speed_rad_per_s{0.3};  ///< at a singular value of zero; >= 0
};

/// Away from the joints' limits: minus the gradient of sum_i ((zone - d_i) / zone)^3 zone / 3, d_i the
/// distance to the nearer limit. Zero in mid range, continuously differentiable everywhere.
/// @param margin_rad kept from the limits.
template <int N>
[[nodiscard]] JointVectorN<N> AwayFromLimits(
    const PosturePreferenceParams& params, const std::array<JointLimits, static_cast<std::size_t>(N)>& limits,
    double margin_rad, const JointVectorN<N>& q) OSTEON_RT;

/// Away from a singular posture: up the gradient of the smallest singular value, which comes from the tick
/// before (MotionOutput).
template <int N>
[[nodiscard]] JointVectorN<N> AwayFromSingularity(const PosturePreferenceParams& params, double sigma_min_m,
                                                  const JointVectorN<N>& sigma_gradient_m) OSTEON_RT;

}  // namespace osteon::kinematics
