#pragma once

#include "base/marker.h"
#include "kinematics/chain_params.h"

// Force that an arm can hold at a posture, by its joint torques. A wrench F that the arm exerts at a point of
// its flange requires of joint i, at rest,
//
//     tau_i = g_i + b_i,   b = J^T F,   |tau_i| <= tau_max_i
//
// so each joint gives two half-spaces in wrench space, r+_i = tau_max_i - g_i and r-_i = tau_max_i + g_i away
// from the origin:  b_i <= r+_i,  -b_i <= r-_i.  A whole set of wrenches is held if the set's support
// function along each half-space's normal stays within it. The minimum over a cone, a circle or a ball has a
// closed form per joint, so nothing is sampled.

namespace osteon::kinematics {

/// Caps of force and torque, far above the loads that any arm is made for. Where no joint torque resists (a
/// singular posture, along the lost direction) the arm's structure carries the load and this model does not
/// apply.
inline constexpr double kForceCap_N = 1e4;
inline constexpr double kTorqueCap_Nm = 1e4;

/// Whether gravity counts as relief of a drive.
enum class GravityHelp {
  kCounted,     ///< r± = tau_max -+ g: exact, as far as the masses are known
  kNotCounted,  ///< r+ = r- = tau_max - |g|: the same for either sign of the force; at most the exact value
};

/// A largest force, torque or factor, and the joint that limits it.
struct CapabilityLimit {
  double value{0.0};  ///< >= 0, finite
  int joint{-1};      ///< index of the joint at its torque limit; -1: the cap limits
};

/// A set of loads at the tool: every force a along the axis with a from 0 to axial_N, plus any force across
/// it up to lateral_N, plus any torque up to torque_Nm, all at once.
struct ToolLoad {
  double axial_N{0.0};    ///< sign: along the axis or against it
  double lateral_N{0.0};  ///< >= 0
  double torque_Nm{0.0};  ///< >= 0
};

/// The force capability of one posture. All results are for an arm at rest; nothing allocates or throws. If
/// the arm cannot hold itself (|g_i| > tau_max_i), or an input is not finite, every result is zero.
template <int N>
class ForceCapability {
 public:
  /// @param J  Jacobian of the point that the wrenches act on (6 x N, rows v then w); all directions and
  ///   wrenches below are expressed in its frame
  /// @param gravity_Nm  torques that hold the arm with its payload, tau = g(q)
  /// @param torque_limit_Nm  tau_max, >= 0
  ForceCapability(const JacobianN<N>& J, const JointVectorN<N>& gravity_Nm,
                  const JointVectorN<N>& torque_limit_Nm, GravityHelp help) OSTEON_RT;

  /// Largest f such that f u is held together with any torque up to torque_Nm. u unit.
  ///
  ///     f = min_i (r_i - torque |Jw_i|) / |Jv_i·u|,   r_i on the side that u loads
  [[nodiscard]] CapabilityLimit Force(const Vector3& u, double torque_Nm = 0.0) const OSTEON_RT;

  /// Largest s such that s F is held; s |F.f| <= kForceCap_N and s |F.t| <= kTorqueCap_Nm. Zero for F = 0.
  [[nodiscard]] CapabilityLimit Factor(const Wrench& F) const OSTEON_RT;

  /// Guaranteed lateral force: the minimum of Force over the circle of directions across the axis (unit),
  /// while axial_N (signed) acts along it.
  ///
  ///     f = min over i and sign of (r±_i -+ axial Jv_i·a - torque |Jw_i|) / |Jv_i - (Jv_i·a) a|
  [[nodiscard]] CapabilityLimit LateralForce(const Vector3& axis, double axial_N = 0.0,
                                             double torque_Nm = 0.0) const OSTEON_RT;

  /// Largest k such that k times the whole set of loads is held: 1 or more if the arm can hold the set.
  ///
  ///     b±_i = max(0, ±axial Jv_i·a) + lateral |Jv_i - (Jv_i·a) a| + torque |Jw_i|
  ///     k = min over i and sign of r±_i / b±_i
  ///
  /// Capped as above; zero for a set without a load.
  [[nodiscard]] CapabilityLimit Factor(const Vector3& axis, const ToolLoad& load) const OSTEON_RT;

  /// The share of F that the arm can hold, s = min(1, Factor(F)): the pose-dependent scale of a wrench
  /// limiter. 1 for F = 0.
  [[nodiscard]] double HoldableShare(const Wrench& F) const OSTEON_RT;

 private:
  JacobianN<N> J_;
  JointVectorN<N> room_up_, room_down_;  ///< r+, r- [N·m]
  bool holds_itself_{false};
};

extern template class ForceCapability<6>;
extern template class ForceCapability<7>;

}  // namespace osteon::kinematics
