#pragma once

#include <complex>
#include <vector>

#include <Eigen/Dense>

#include "hil/arm/dynamic_arm.h"
#include "kinematics/chain_params.h"

namespace osteon::studies {

/// An arm that compensates its own weight and has its own impedance control, to which a wrench or torques are
/// added.
struct ImpedanceArmParams {
  kinematics::ChainParams<7> chain;  ///< including the load on the flange; its friction is ignored
  hil::DynamicArmParams arm;         ///< its mass error and mount are ignored
  Pose X_FT{Pose::Identity()};
  kinematics::JointVectorN<7> q{kinematics::JointVectorN<7>::Zero()};  ///< the posture
  Vector3 gravity_B{kinematics::kGravity_W_m_per_s2};
  /// True: joint impedance, torques are added; false: Cartesian impedance, a wrench is added.
  bool torque{false};
};

/// The arm's linear equation at a posture, with the wrench F on the tool, the Jacobian J and the equilibrium
/// q_eq:
///
///     inertia qdd + damping qd + stiffness (q - q_eq) = J^T F
///
/// The equations are those that dynamic_arm.h documents, computed from the chain's mass matrix and Jacobian.
struct ImpedanceArm {
  Eigen::Matrix<double, 6, 7> J;  ///< Jacobian of the tool, in B; rows of v (3), then of w (3)
  Eigen::Matrix<double, 7, 7> inertia, damping, stiffness;
};
/// Computes the matrices. @param mass_ratio  factor on all masses of the chain; > 0
[[nodiscard]] ImpedanceArm ImpedanceArmAt(const ImpedanceArmParams& params, double mass_ratio = 1.0);

/// The matrices of the arm on a compliant mount, by the equations of flexible_mount.h. The coordinates are
/// the joints (7), then the base's motion in B (3 + 3). The drives' torques act only on the joints.
struct MountedArm {
  using Matrix = Eigen::Matrix<double, 13, 13>;
  Matrix inertia, damping, stiffness;
};
[[nodiscard]] MountedArm OnMount(const ImpedanceArm& arm, const ImpedanceArmParams& params,
                                 const hil::FlexibleMountParams& mount, double mass_ratio = 1.0);

/// A 6 × 6 matrix for twists: `linear` on the diagonal of the velocities, `turning` on that of the rotations.
[[nodiscard]] Eigen::Matrix<double, 6, 6> DiagonalOfTwist(double linear, double turning);

/// Means of the tool's effective mass and inertia over all directions. DynamicArm computes its Cartesian
/// damping from them.
struct MeanMasses {
  double linear_kg, turning_kg_m2;
};
[[nodiscard]] MeanMasses MeanMassesOf(const ImpedanceArmParams& params, double mass_ratio = 1.0);

/// Matrices that give the state (q, qd) after a time: `free` from the state before, `forced` from a torque
/// that is constant meanwhile.
struct SampledArm {
  Eigen::Matrix<double, 14, 14> free;
  Eigen::Matrix<double, 14, 7> forced;
};
[[nodiscard]] SampledArm Sample(const ImpedanceArm& arm, double seconds);

/// Response x / f [m/N] of the tool's motion along an axis to a force along it, sampled. Each force f[k] is
/// held for a period; x[k] is the position in the message that f[k] answers, as in SampledResponse(). The
/// response is exact, computed from the modes of the arm's equation.
class OverlayResponse {
 public:
  /// @param along  torques of the joints per force along the axis: J^T axis
  /// @param dead_time_s  from a force to its first effect, >= 0
  OverlayResponse(const ImpedanceArm& arm, const kinematics::JointVectorN<7>& along, double dead_time_s,
                  double period_s);
  OverlayResponse(const MountedArm& arm, const kinematics::JointVectorN<7>& along, double dead_time_s,
                  double period_s);
  [[nodiscard]] std::complex<double> operator()(double hz) const;

 private:
  struct Mode {
    std::complex<double> free;         // factor on the mode's state over a period without a force
    std::complex<double> now, before;  // change of x per force that was sent n or n + 1 periods ago
  };
  void AddModes(const Eigen::MatrixXd& inertia, const Eigen::MatrixXd& damping,
                const Eigen::MatrixXd& stiffness, const kinematics::JointVectorN<7>& along, double rest_s);

  std::vector<Mode> modes_;
  int periods_;  // number n of whole periods in the dead time
  double period_s_;
};

}  // namespace osteon::studies
