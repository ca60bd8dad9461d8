#pragma once

#include "base/marker.h"
#include "kinematics/chain_params.h"

// Force that an arm can hold at a posture, by its joint torques. A wrench F that the arm exerts at a point of
// its flange requires of joint i, at rest,
//
//     tau_i = g_i + b_i,   b = J^T F,   |tau_i| <= tau_max_i
//
// where g_i holds the arm's weight and b_i the wrench. So each joint gives two half-spaces in wrench space:
// b_i <= r+_i = tau_max_i - g_i and -b_i <= r-_i = tau_max_i + g_i.  The arm holds a whole set of wrenches if
// the set's largest b_i and -b_i are within these bounds. For a cone, a circle or a ball of wrenches these
// extremes have a closed form per joint, so nothing is sampled.

namespace osteon::kinematics {

/// Caps of force and torque, far above the loads that any arm is made for. In a singular posture, along the
/// direction that the arm cannot move in, no joint torque resists a force: the arm's structure carries it,
/// this model does not apply, and the result is the cap.
inline constexpr double kForceCap_N = 1e4;
inline constexpr double kTorqueCap_Nm = 1e4;

/// Whether the arm's weight may reduce the torque that a drive needs.
enum class GravityHelp {
  kCounted,     ///< r± = tau_max ∓ g: exact if the masses are
  kNotCounted,  ///< r+ = r- = tau_max - |g|: never more than the exact value; independent of the sign of the
                ///< force
};

/// A largest force, torque or factor, and the joint that limits it.
struct CapabilityLimit {
  double value{0.0};  ///< >= 0, finite
  int joint{-1};      ///< index of the joint at its torque limit; -1: the result is the cap
};

/// A set of loads at the tool that act together: a force along the axis between 0 and axial_N, a force up to
/// lateral_N in any direction across the axis, and a torque up to torque_Nm about any axis.
struct ToolLoad {
  double axial_N{0.0};    ///< positive: along the axis; negative: against it
  double lateral_N{0.0};  ///< >= 0
  double torque_Nm{0.0};  ///< >= 0
};

/// The force capability of one posture. All results are for an arm at rest. No function allocates or throws.
/// If the arm cannot hold itself (|g_i| > tau_max_i), or an input is not finite, every result is zero.
template <int N>
class ForceCapability {
 public:
  /// @param J  Jacobian of the point that the wrenches act on (6 x N, rows v then w); all directions and
  ///   wrenches below are expressed in its frame
  /// @param gravity_Nm  torques that hold the arm with its payload, tau = g(q)
  /// @param torque_limit_Nm  tau_max, >= 0
  ForceCapability(const JacobianN<N>& J, const JointVectorN<N>& gravity_Nm,
                  const JointVectorN<N>& torque_limit_Nm, GravityHelp help) OSTEON_RT;

  /// Largest force f that the arm can hold along the unit vector u, together with any torque up to torque_Nm.
  /// Jv_i and Jw_i are the linear and angular part of column i of J:
  ///
  ///     f = min_i (r_i - torque |Jw_i|) / |Jv_i·u|,   r_i on the side that u loads
  [[nodiscard]] CapabilityLimit Force(const Vector3& u, double torque_Nm = 0.0) const OSTEON_RT;

  /// Largest factor s for which the arm can hold s F, limited so that s |F.f| <= kForceCap_N and s |F.t| <=
  /// kTorqueCap_Nm. Zero for F = 0.
  [[nodiscard]] CapabilityLimit Factor(const Wrench& F) const OSTEON_RT;

  /// Lateral force that the arm can hold in every direction across the unit axis, while axial_N (signed) acts
  /// along the axis:
  ///
  ///     f = min over i and sign of (r±_i -+ axial Jv_i·a - torque |Jw_i|) / |Jv_i - (Jv_i·a) a|
  [[nodiscard]] CapabilityLimit LateralForce(const Vector3& axis, double axial_N = 0.0,
                                             double torque_Nm = 0.0) const OSTEON_RT;

  /// Largest factor k for which the arm can hold k times every load of the set: 1 or more if the arm can hold
  /// the set.
  ///
  ///     b±_i = max(0, ±axial Jv_i·a) + lateral |Jv_i - (Jv_i·a) a| + torque |Jw_i|
  ///     k = min over i and sign of r±_i / b±_i
  ///
  /// Limited by the caps as Factor(F); zero for a set without a load.
  [[nodiscard]] CapabilityLimit Factor(const Vector3& axis, const ToolLoad& load) const OSTEON_RT;

  /// Share of F that the arm can hold in this posture, s = min(1, Factor(F)); 1 for F = 0. A wrench limiter
  /// uses it as a scale.
  [[nodiscard]] double HoldableShare(const Wrench& F) const OSTEON_RT;

 private:
  JacobianN<N> J_;
  JointVectorN<N> room_up_, room_down_;  ///< r+, r- [N·m]
  bool holds_itself_{false};
};

extern template class ForceCapability<6>;
extern template class ForceCapability<7>;

}  // namespace osteon::kinematics
