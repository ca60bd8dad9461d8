#include "kinematics/redundancy.h"

#include <algorithm>

namespace osteon::kinematics {

template <int N>
JointVectorN<N> AwayFromLimits(const PosturePreferenceParams& params,
                               const std::array<JointLimits, static_cast<std::size_t>(N)>& limits,
                               double margin_rad, const JointVectorN<N>& q) OSTEON_RT {
  JointVectorN<N> qd;
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = limits[static_cast<std::size_t>(i)];
    const double below = q[i] - limit.lower_rad - margin_rad, above = limit.upper_rad - margin_rad - q[i];
    const double up = std::clamp(1.0 - below / params.limit_zone_rad, 0.0, 1.0);
    const double down = std::clamp(1.0 - above / params.limit_zone_rad, 0.0, 1.0);
    qd[i] = params.limit_speed_rad_per_s * (up * up - down * down);
  }
  return qd;
}

template <int N>
JointVectorN<N> AwayFromSingularity(const PosturePreferenceParams& params, double sigma_min_m,
                                    const JointVectorN<N>& sigma_gradient_m) OSTEON_RT {
  constexpr double kFlat_m = 1e-3;  // gradient below which there is hardly a way up: no unit vector of noise
  const double depth = std::clamp(1.0 - sigma_min_m / params.singular_zone_m, 0.0, 1.0);
  const double slope = std::max(sigma_gradient_m.norm(), kFlat_m);
  return (params.singular_speed_rad_per_s * depth * depth / slope) * sigma_gradient_m;
}

template JointVectorN<6> AwayFromLimits<6>(const PosturePreferenceParams&, const std::array<JointLimits, 6>&,
                                           double, const JointVectorN<6>&) OSTEON_RT;
template JointVectorN<7> AwayFromLimits<7>(const PosturePreferenceParams&, const std::array<JointLimits, 7>&,
                                           double, const JointVectorN<7>&) OSTEON_RT;
template JointVectorN<6> AwayFromSingularity<6>(const PosturePreferenceParams&, double,
                                                const JointVectorN<6>&) OSTEON_RT;
template JointVectorN<7> AwayFromSingularity<7>(const PosturePreferenceParams&, double,
                                                const JointVectorN<7>&) OSTEON_RT;

}  // namespace osteon::kinematics
