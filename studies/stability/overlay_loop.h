#pragma once

#include <Eigen/Dense>

#include "control/laws/impedance_law.h"
#include "hil/arm/dynamic_arm.h"
#include "hil/loops/admittance_loop.h"
#include "hil/operator/hand_grid.h"

// The loop of the impedance law: a hand holds an arm that compensates its own weight; a wrench or torques are
// added to the arm's own impedance control.
//
//     hand ── k, b, m ── arm with masses, its own impedance ◀── dead time ◀── wall K, damping D of the law
//      └──────────── measured pose and its filtered velocity ────────────────────┘

namespace osteon::studies {

/// The arm, the law, the hand and the wall of the loop.
struct OverlayLoopParams {
  kinematics::ChainParams<7> chain;  ///< including the load on the flange; its friction is ignored
  hil::DynamicArmParams arm;         ///< its mass error is ignored
  Pose X_FT{Pose::Identity()};
  kinematics::JointVectorN<7> q{kinematics::JointVectorN<7>::Zero()};  ///< the posture
  Vector3 gravity_B{kinematics::kGravity_W_m_per_s2};
  /// True: joint impedance, torques are added; false: Cartesian impedance, a wrench is added.
  bool torque{false};
  control::ImpedanceParams law;
  hil::GridHand hand{
      "firm", 500.0, 20.0,
      1.5};  ///< isotropic at the tool; it resists rotation as if at OperatorWith's lever of a grip
  /// Wall across the tool's z axis. It acts on the measured pose of age_ticks ticks ago; `on` is not used.
  hil::LoopWall wall{};
  double period_s{0.001};
};

/// The linear loop at the posture, without friction. The hand's mass moves with the tool, but the arm's
/// controller does not know it: its springs and damping are those of the arm without a hand. The arm's
/// equations are those of dynamic_arm.h, computed from the chain's mass matrix and Jacobian. The forces of
/// hand and overlay are constant over a period, as in the simulation.
class OverlayLoop {
 public:
  explicit OverlayLoop(const OverlayLoopParams& params);

  [[nodiscard]] Eigen::MatrixXd Matrix() const;
  /// Whether no motion grows. A motion of the elbow may persist, since no force restores it.
  [[nodiscard]] bool IsStable() const { return hil::SpectralRadius(Matrix()) < 1.0 + 1e-7; }
  /// Square of the lever with which a hand resists rotation, as in OperatorWith [m^2].
  [[nodiscard]] static constexpr double lever2_m2() { return 0.1 * 0.1; }
  /// Effective mass of the tool along its z axis at this posture, without the hand [kg].
  [[nodiscard]] double mass_kg() const { return mass_kg_; }

 private:
  using Matrix6x7 = Eigen::Matrix<double, 6, 7>;
  [[nodiscard]] Eigen::VectorXd Step(const Eigen::VectorXd& state) const;

  OverlayLoopParams params_;
  Matrix6x7 J_;  // Jacobian of the tool, in B
  // stiffness of the arm's own springs: torque per displacement of their equilibrium
  Eigen::Matrix<double, 7, 7> follow_;
  Eigen::Matrix<double, 14, 14> free_;           // state (q, qd) after a period, per state before
  Eigen::Matrix<double, 14, 7> forced_;          // state (q, qd) after a period, per constant torque
  Eigen::Matrix<double, 6, 6> damping_;          // damping of the law, in B
  Eigen::Matrix<double, 6, 6> hand_k_, hand_b_;  // the hand's stiffness and damping
  Vector3 axis_B_;                               // direction of the tool's z axis, in B
  double mass_kg_{0.0};
  int size_{0};
};

/// Simulates the same loop in time with the shipped DynamicArm, EvaluateCoupling, MeasuredTwist and
/// DampingWrench. The tool is pressed on the wall with 20 N, and pushed with 1 N for 10 ms.
/// @returns whether the tool's motion grows
[[nodiscard]] bool OverlayGrows(const OverlayLoopParams& params, double seconds = 1.5);

}  // namespace osteon::studies
