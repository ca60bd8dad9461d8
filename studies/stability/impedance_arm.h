#pragma once

#include <complex>
#include <vector>

#include <Eigen/Dense>

#include "hil/arm/dynamic_arm.h"
#include "kinematics/chain_params.h"

namespace osteon::studies {

/// An arm that compensates its own weight and holds its own impedance, to which a wrench or torques are
/// added.
struct ImpedanceArmParams {
  kinematics::ChainParams<7> chain;  ///< including the load on the flange; its friction is ignored
  hil::DynamicArmParams arm;         ///< its mass error and mount are ignored
  Pose X_FT{Pose::Identity()};
  kinematics::JointVectorN<7> q{kinematics::JointVectorN<7>::Zero()};  ///< the posture
  Vector3 gravity_B{kinematics::kGravity_W_m_per_s2};
  bool torque{false};  ///< joint impedance with torques over it; else Cartesian impedance and a wrench
};

/// The arm's linear equation at a posture, with F on the tool and the equilibrium q_eq:
///
///     inertia qdd + damping qd + stiffness (q - q_eq) = J^T F
///
/// The equations are those that dynamic_arm.h documents, from the chain's mass matrix and Jacobian.
struct ImpedanceArm {
  Eigen::Matrix<double, 6, 7> J;  ///< of the tool, rows v (3) then w (3), in B
  Eigen::Matrix<double, 7, 7> inertia, damping, stiffness;
};
/// Computes the matrices. @param mass_ratio  factor on all masses of the chain; > 0
[[nodiscard]] ImpedanceArm ImpedanceArmAt(const ImpedanceArmParams& params, double mass_ratio = 1.0);

/// The matrices of the arm on a mount that gives way, by the equations of flexible_mount.h: the joints (7),
/// then the base's motion in B (3 + 3). The drives' torques act only on the joints.
struct MountedArm {
  using Matrix = Eigen::Matrix<double, 13, 13>;
  Matrix inertia, damping, stiffness;
};
[[nodiscard]] MountedArm OnMount(const ImpedanceArm& arm, const ImpedanceArmParams& params,
                                 const hil::FlexibleMountParams& mount, double mass_ratio = 1.0);

/// The matrix with `linear` on the diagonal of a twist's velocities and `turning` on that of its rotations.
[[nodiscard]] Eigen::Matrix<double, 6, 6> DiagonalOfTwist(double linear, double turning);

/// Means of the tool's mass and inertia over all directions, by which DynamicArm sets its Cartesian damping.
struct MeanMasses {
  double linear_kg, turning_kg_m2;
};
[[nodiscard]] MeanMasses MeanMassesOf(const ImpedanceArmParams& params, double mass_ratio = 1.0);

/// Matrices that give (q, qd) after a time: from (q, qd) before, and from a torque that is held meanwhile.
struct SampledArm {
  Eigen::Matrix<double, 14, 14> free;
  Eigen::Matrix<double, 14, 7> forced;
};
[[nodiscard]] SampledArm Sample(const ImpedanceArm& arm, double seconds);

/// Response x / f [m/N] of the tool's motion along an axis to a force along it, sampled: the forces f[k] are
/// held for a period, x[k] is the position in the message that f[k] answers, as in SampledResponse(). The
/// response is exact, computed from the modes of the equation.
class OverlayResponse {
 public:
  /// @param along  J^T of the axis: torques of the joints by a force along it
  /// @param dead_time_s  from a force to its first effect, >= 0
  OverlayResponse(const ImpedanceArm& arm, const kinematics::JointVectorN<7>& along, double dead_time_s,
                  double period_s);
  OverlayResponse(const MountedArm& arm, const kinematics::JointVectorN<7>& along, double dead_time_s,
                  double period_s);
  [[nodiscard]] std::complex<double> operator()(double hz) const;

 private:
  struct Mode {
    std::complex<double> free;         // factor on the mode over a period without a force
    std::complex<double> now, before;  // change of x by a force that was sent n and n + 1 periods ago
  };
  void AddModes(const Eigen::MatrixXd& inertia, const Eigen::MatrixXd& damping,
                const Eigen::MatrixXd& stiffness, const kinematics::JointVectorN<7>& along, double rest_s);

  std::vector<Mode> modes_;
  int periods_;  // whole periods of the dead time: n
  double period_s_;
};

}  // namespace osteon::studies
