#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

// The impedance law, for an arm whose own controller runs impedance control. It computes a wrench that is
// added to the wrench of the arm's controller. It does not integrate a motion.

namespace osteon::control {

/// Tuning of the impedance law. Every field has a usable default.
struct ImpedanceParams {
  /// damping for each axis of T, in addition to the arm's own damping; >= 0
  Vector3 damping_Ns_per_m{10.0, 10.0, 10.0};
  Vector3 damping_Nms_per_rad{0.5, 0.5, 0.5};
  /// Gain of the brake against the part of the tool's twist that speed limit or workspace do not allow. A
  /// brake is needed because the hand moves the arm, so that no command can scale the motion.
  double brake_Ns_per_m{250.0}, brake_Nms_per_rad{5.0};
  double twist_filter_s{0.002};  ///< time constant of the first-order filter on the measured velocity; >= 0
  /// Time constant with which the equilibrium of the arm's own spring follows the measured position; > 0. The
  /// hand then feels the damping K follow_s, with the stiffness K of that spring.
  double follow_s{0.005};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ImpedanceParams& params);

/// Returns the parameters with damping multiplied; the brake is unchanged.
[[nodiscard]] ImpedanceParams ScaleLaw(const ImpedanceParams& params, double damping_factor) OSTEON_RT;

/// Computes the tool's velocity from its measured poses: the difference of two poses divided by the time
/// (TwistBetween), then a first-order filter.
class MeasuredTwist {
 public:
  explicit MeasuredTwist(double filter_s) : filter_s_(filter_s) {}

  /// Restarts at rest at a pose.
  void Reset(const Pose& X_WT) OSTEON_RT;
  /// Adds a measured pose.
  /// @param dt_s  time since the previous pose, > 0; more than a period if messages were lost
  /// @returns the velocity of T at To, in W; it lags by half of dt_s plus filter_s
  const Twist& Step(const Pose& X_WT, double dt_s) OSTEON_RT;
  /// The velocity as of the last Step.
  [[nodiscard]] const Twist& V() const OSTEON_RT { return V_; }

 private:
  double filter_s_;
  Pose X_before_{Pose::Identity()};
  Twist V_;
};

/// Computes the wrench of damping and brake, which is added to the coupling's:
///
///     F = -D V + B (V_allowed - V)
///
/// V is the tool's twist, V_allowed the part of it that the limits allow, D the damping (diagonal in T) and B
/// the brake's gain (isotropic). If V_allowed is V times a factor of at most 1, the wrench removes energy.
[[nodiscard]] Wrench DampingWrench(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT,
                                   const Twist& V_allowed_WT) OSTEON_RT;

}  // namespace osteon::control
