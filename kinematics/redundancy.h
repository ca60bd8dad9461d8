#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/force_capability.h"
#include "kinematics/serial_chain.h"

// Posture preferences, expressed as joint velocities. Their sum is passed as MotionInput::qd_null, and the
// differential inverse follows its null-space part.

namespace osteon::kinematics {

struct PosturePreferenceParams {
  double limit_zone_rad{0.35};        ///< width of the zone at each end of a joint's range; > 0
  double limit_speed_rad_per_s{0.3};  ///< preferred speed at the limit itself; >= 0
  double singular_zone_m{0.07};       ///< postures with a smaller singular value than this are avoided; > 0
  double singular_speed_rad_per_s{0.3};  ///< preferred speed at a singular value of zero; >= 0
  /// Factor on the wanted load; > 1. From a posture that can hold less than this multiple of the load, the
  /// preference moves the arm toward one that can hold more.
  double load_zone{1.5};
  /// preferred speed in a posture that can hold no more than the load; >= 0
  double load_speed_rad_per_s{0.3};
};

/// The load that a posture should be able to hold, and its point of action.
template <int N>
struct LoadTarget {
  ToolLoad load;                     ///< zero: no preference
  Vector3 p_F{Vector3::Zero()};      ///< point of action, in the flange's frame [m]
  Vector3 axis_F{Vector3::UnitZ()};  ///< axis of the load, unit, in the flange's frame
  JointVectorN<N> torque_limit_Nm{JointVectorN<N>::Zero()};  ///< of the drives; > 0
};

/// Leads away from the joints' limits: joint i moves away from its limit with the speed
///
///     limit_speed ((zone - d_i) / zone)^2        d_i: distance to the nearer limit less margin_rad
///
/// where d_i is below the zone, and rests elsewhere. The speed is continuously differentiable.
/// @param margin_rad distance kept from the limits: there, a joint has the whole speed.
template <int N>
[[nodiscard]] JointVectorN<N> AwayFromLimits(
    const PosturePreferenceParams& params, const std::array<JointLimits, static_cast<std::size_t>(N)>& limits,
    double margin_rad, const JointVectorN<N>& q) OSTEON_RT;

/// Joint velocity away from a singular posture: along the gradient of the smallest singular value. Pass the
/// values of the previous tick's MotionOutput.
template <int N>
[[nodiscard]] JointVectorN<N> AwayFromSingularity(const PosturePreferenceParams& params, double sigma_min_m,
                                                  const JointVectorN<N>& sigma_gradient_m) OSTEON_RT;

/// Largest multiple of the load that the arm can hold, without counting on the arm's weight to relieve a
/// drive.
/// @param J  geometric Jacobian of the point target.p_F
/// @param gravity_Nm  torques that hold the arm up
/// @param axis        target.axis_F, unit, in J's frame
template <int N>
[[nodiscard]] CapabilityLimit HeldLoad(const LoadTarget<N>& target, const JacobianN<N>& J,
                                       const JointVectorN<N>& gravity_Nm, const Vector3& axis) OSTEON_RT;

/// Largest multiple of the load that the arm can hold at q, with Jacobian and gravity torques computed from
/// the chain. @pre chain.params().has_masses
template <int N>
[[nodiscard]] CapabilityLimit HeldLoad(const SerialChain<N>& chain, const LoadTarget<N>& target,
                                       const JointVectorN<N>& q) OSTEON_RT;

template <int N>
struct LoadPreference {
  JointVectorN<N> qd{JointVectorN<N>::Zero()};  ///< [rad/s]
  /// 0: the posture can hold load_zone times the load; 1: it can hold no more than the load
  double depth{0.0};
};

/// A posture, and the load that it can hold.
template <int N>
struct LoadedPosture {
  const JointVectorN<N>& q;  ///< [rad]
  const JointVectorN<N>& n;  ///< unit null direction at q; zero: none
  double held{0.0};  ///< HeldLoad at q, by the caller: a tick has the Jacobian and gravity at q already
};

/// Joint velocity toward postures that can hold more of the load. With k the value of HeldLoad and k' its
/// slope along the unit null direction n,
///
///     qd = speed depth^2 k' / (|k'| + 0.2/rad) n       depth = (zone - k) / (zone - 1), 0 … 1
///
/// with speed = load_speed_rad_per_s and zone = load_zone. k is the minimum of one smooth function per joint,
/// so that it has a kink where the limiting joint changes. k' is an average slope over ±0.02 rad: the motion
/// stops at a kink instead of alternating across it.
/// @pre chain.params().has_masses
template <int N>
[[nodiscard]] LoadPreference<N> LoadGradientMotion(const PosturePreferenceParams& params,
                                                   const SerialChain<N>& chain, const LoadTarget<N>& target,
                                                   const LoadedPosture<N>& posture) OSTEON_RT;

}  // namespace osteon::kinematics
