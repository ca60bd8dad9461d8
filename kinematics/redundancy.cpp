#include "kinematics/redundancy.h"

#include <algorithm>
#include <cmath>

namespace osteon::kinematics {

template <int N>
JointVectorN<N> AwayFromLimits(const PosturePreferenceParams& params,
                               const std::array<JointLimits, static_cast<std::size_t>(N)>& limits,
                               double margin_rad, const JointVectorN<N>& q) OSTEON_RT {
  JointVectorN<N> qd;
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = limits[static_cast<std::size_t>(i)];
    // depth in the zone at each end of the range: 0 at the zone's edge, 1 at the limit
    const double from_lower_rad = q[i] - limit.lower_rad - margin_rad,
                 to_upper_rad = limit.upper_rad - margin_rad - q[i];
    const double up = std::clamp(1.0 - from_lower_rad / params.limit_zone_rad, 0.0, 1.0);
    const double down = std::clamp(1.0 - to_upper_rad / params.limit_zone_rad, 0.0, 1.0);
    qd[i] = params.limit_speed_rad_per_s * (up * up - down * down);
  }
  return qd;
}

template <int N>
JointVectorN<N> AwayFromSingularity(const PosturePreferenceParams& params, double sigma_min_m,
                                    const JointVectorN<N>& sigma_gradient_m) OSTEON_RT {
  // smaller gradients are not normalised to unit length, because their direction is noise
  constexpr double kFlat_m = 1e-3;
  const double depth = std::clamp(1.0 - sigma_min_m / params.singular_zone_m, 0.0, 1.0);
  const double slope = std::max(sigma_gradient_m.norm(), kFlat_m);
  return (params.singular_speed_rad_per_s * depth * depth / slope) * sigma_gradient_m;
}

template <int N>
CapabilityLimit HeldLoad(const LoadTarget<N>& target, const JacobianN<N>& J,
                         const JointVectorN<N>& gravity_Nm, const Vector3& axis) OSTEON_RT {
  return ForceCapability<N>(J, gravity_Nm, target.torque_limit_Nm, GravityHelp::kNotCounted)
      .Factor(axis, target.load);
}

template <int N>
CapabilityLimit HeldLoad(const SerialChain<N>& chain, const LoadTarget<N>& target,
                         const JointVectorN<N>& q) OSTEON_RT {
  const typename SerialChain<N>::Posture posture = chain.ComputePosture(q);
  return HeldLoad<N>(target, chain.JacobianAt(posture, posture.X_BF * target.p_F), chain.Gravity(q),
                     posture.X_BF.linear() * target.axis_F);
}

template <int N>
LoadPreference<N> LoadGradientMotion(const PosturePreferenceParams& params, const SerialChain<N>& chain,
                                     const LoadTarget<N>& target, const LoadedPosture<N>& posture) OSTEON_RT {
  const auto& [q, n, held] = posture;
  // the slope is the difference between the values at plus and minus this angle
  constexpr double kReach_rad = 0.02;
  constexpr double kFlat_per_rad = 0.2;  // slope at which the motion has half its largest speed
  LoadPreference<N> result;
  const bool has_load =
      target.load.axial_N != 0.0 || target.load.lateral_N > 0.0 || target.load.torque_Nm > 0.0;
  if (!has_load || !(params.load_speed_rad_per_s > 0.0) || n.isZero(0.0)) return result;
  if (held >= params.load_zone) return result;
  result.depth = std::min(1.0, (params.load_zone - held) / (params.load_zone - 1.0));
  const double slope = (HeldLoad<N>(chain, target, q + kReach_rad * n).value -
                        HeldLoad<N>(chain, target, q - kReach_rad * n).value) /
                       (2.0 * kReach_rad);
  result.qd = (params.load_speed_rad_per_s * result.depth * result.depth * slope /
               (std::abs(slope) + kFlat_per_rad)) *
              n;
  return result;
}

template JointVectorN<6> AwayFromLimits<6>(const PosturePreferenceParams&, const std::array<JointLimits, 6>&,
                                           double, const JointVectorN<6>&) OSTEON_RT;
template JointVectorN<7> AwayFromLimits<7>(const PosturePreferenceParams&, const std::array<JointLimits, 7>&,
                                           double, const JointVectorN<7>&) OSTEON_RT;
template JointVectorN<6> AwayFromSingularity<6>(const PosturePreferenceParams&, double,
                                                const JointVectorN<6>&) OSTEON_RT;
template JointVectorN<7> AwayFromSingularity<7>(const PosturePreferenceParams&, double,
                                                const JointVectorN<7>&) OSTEON_RT;
template CapabilityLimit HeldLoad<6>(const LoadTarget<6>&, const JacobianN<6>&, const JointVectorN<6>&,
                                     const Vector3&) OSTEON_RT;
template CapabilityLimit HeldLoad<6>(const SerialChain<6>&, const LoadTarget<6>&,
                                     const JointVectorN<6>&) OSTEON_RT;
template CapabilityLimit HeldLoad<7>(const LoadTarget<7>&, const JacobianN<7>&, const JointVectorN<7>&,
                                     const Vector3&) OSTEON_RT;
template CapabilityLimit HeldLoad<7>(const SerialChain<7>&, const LoadTarget<7>&,
                                     const JointVectorN<7>&) OSTEON_RT;
template LoadPreference<6> LoadGradientMotion<6>(const PosturePreferenceParams&, const SerialChain<6>&,
                                                 const LoadTarget<6>&, const LoadedPosture<6>&) OSTEON_RT;
template LoadPreference<7> LoadGradientMotion<7>(const PosturePreferenceParams&, const SerialChain<7>&,
                                                 const LoadTarget<7>&, const LoadedPosture<7>&) OSTEON_RT;

}  // namespace osteon::kinematics
