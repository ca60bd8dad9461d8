#pragma once

#include <array>

#include "control/rt/marker.h"
#include "kinematics/force_capability.h"
#include "kinematics/serial_chain.h"

// Preferences of the posture, as joint velocities whose part in the null space a differential inverse follows
// (MotionInput::qd_null). They add up.

namespace osteon::kinematics {

struct PosturePreferenceParams {
  double limit_zone_rad{0.35};        ///< of a joint's range at either end: from here on it is led back; > 0
  double limit_speed_rad_per_s{0.3};  ///< at the limit itself; >= 0
  double singular_zone_m{0.07};       ///< smallest singular values below this are led up; > 0
  double singular_speed_rad_per_s{0.3};  ///< at a singular value of zero; >= 0
  double load_zone{
      1.5};  ///< of the load wanted: a posture that holds less is led to one that holds more; > 1
  double load_speed_rad_per_s{0.3};  ///< where no more than the load is held; >= 0
};

/// What a posture should be able to hold, and where.
template <int N>
struct WantedLoad {
  ToolLoad load;                                             ///< with nothing in it: no preference
  Vector3 p_F{Vector3::Zero()};                              ///< where it acts, in the flange's frame [m]
  Vector3 axis_F{Vector3::UnitZ()};                          ///< its axis, unit, in the flange's frame
  JointVectorN<N> torque_limit_Nm{JointVectorN<N>::Zero()};  ///< of the drives; > 0
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

/// Largest multiple of the load that the arm holds, whichever way gravity helps.
/// @param J           geometric, of the point wanted.p_F
/// @param gravity_Nm  what holds the arm up
/// @param axis        wanted.axis_F, unit, in J's frame
template <int N>
[[nodiscard]] CapabilityLimit HeldLoad(const WantedLoad<N>& wanted, const JacobianN<N>& J,
                                       const JointVectorN<N>& gravity_Nm, const Vector3& axis) OSTEON_RT;

/// The same at q, all of it from the chain. @pre chain.params().has_masses
template <int N>
[[nodiscard]] CapabilityLimit HeldLoad(const SerialChain<N>& chain, const WantedLoad<N>& wanted,
                                       const JointVectorN<N>& q) OSTEON_RT;

template <int N>
struct LoadPreference {
  JointVectorN<N> qd{JointVectorN<N>::Zero()};  ///< [rad/s]
  double depth{0.0};  ///< 0: the posture holds the zone's multiple of the load; 1: no more than the load
};

/// Towards postures that hold more of the load: up the slope of HeldLoad along the unit null direction n,
///
///     qd = speed depth^2 k' / (|k'| + .2/rad) n        depth = (zone - k) / (zone - 1), 0 … 1
///
/// k is the least over the joints of smooth functions, with edges where the joint that limits changes; k' is
/// the difference over ±.02 rad, the slope of k averaged over that much, so that the way up ends on an edge
/// instead of going to and fro across it.
/// @param held  HeldLoad at q: in a tick, what it is made of is known already
/// @pre chain.params().has_masses
template <int N>
[[nodiscard]] LoadPreference<N> TowardsLoad(const PosturePreferenceParams& params,
                                            const SerialChain<N>& chain, const WantedLoad<N>& wanted,
                                            const JointVectorN<N>& q, const JointVectorN<N>& n,
                                            double held) OSTEON_RT;

}  // namespace osteon::kinematics
