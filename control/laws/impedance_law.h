#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

// The law for an arm in its controller's own impedance control: adds a wrench to the arm's, integrates
// nothing.

namespace osteon::control {

/// Tuning of the impedance law. Every field has a usable default.
struct ImpedanceParams {
  Vector3 damping_Ns_per_m{10.0, 10.0, 10.0};  ///< by axis of T, beside the arm's own; >= 0
  Vector3 damping_Nms_per_rad{0.5, 0.5, 0.5};
  /// Brakes what the tool moves beyond its allowed twist (speed limit, workspace): the hand holds the arm, so
  /// a command cannot scale its motion.
  double brake_Ns_per_m{250.0}, brake_Nms_per_rad{5.0};
  double twist_filter_s{0.002};  ///< first order, of the measured velocity; >= 0
  /// Time constant with which the equilibrium of the arm's own spring follows the measured arm; > 0. With a
  /// stiffness K of that spring the hand feels a damping K follow_s.
  double follow_s{0.005};
};

/// @throws std::invalid_argument naming the field, the value found and what is accepted.
void Validate(const ImpedanceParams& params);

/// Returns the same law with its damping multiplied; its brake stays.
[[nodiscard]] ImpedanceParams ScaleLaw(const ImpedanceParams& params, double damping_factor) OSTEON_RT;

/// Velocity of the tool from its measured poses: pose difference over time, the rotation by its logarithm,
/// then a first-order filter.
class MeasuredTwist {
 public:
  explicit MeasuredTwist(double filter_s) : filter_s_(filter_s) {}

  /// Starts at rest at a pose.
  void Reset(const Pose& X_WT) OSTEON_RT;
  /// @param dt_s  since the pose before: more than a period if messages were lost; > 0
  /// @returns the velocity of T at To, in W, half of dt_s and filter_s old
  const Twist& Step(const Pose& X_WT, double dt_s) OSTEON_RT;
  /// Velocity of the last step.
  [[nodiscard]] const Twist& V() const OSTEON_RT { return V_; }

 private:
  double filter_s_;
  Pose X_before_{Pose::Identity()};
  Twist V_;
};

/// Damping and braking, beside the coupling:
///
///     F = -D V + B (V_allowed - V)
///
/// by axis of T; B is isotropic. Takes power wherever |V_allowed| <= |V| along the same line.
[[nodiscard]] Wrench DampingWrench(const ImpedanceParams& params, const Matrix3& R_WT, const Twist& V_WT,
                                   const Twist& V_allowed_WT) OSTEON_RT;

}  // namespace osteon::control
