#pragma once

#include <array>
#include <optional>

#include "hil/arm/arm_model.h"
#include "hil/arm/flexible_mount.h"
#include "kinematics/serial_chain.h"

namespace osteon::hil {

/// Parameters of DynamicArm. All values are assumed: none was measured on an arm.
struct DynamicArmParams {
  /// Figures of the position controller; dead time and damping ratio mean the same as in ServoArm.
  double bandwidth_hz{15.0};
  double damping_ratio{1.0};
  int dead_cycles{3};  ///< whole periods from a command to its first effect, 0 … 32
  /// Stiffness in joint impedance.
  kinematics::JointVectorN<7> stiffness_Nm_per_rad{kinematics::JointVectorN<7>::Constant(500.0)};
  /// Damping ratio of each joint alone, with its inertia in the posture at the start.
  double joint_damping_ratio{0.7};
  /// Stiffness in Cartesian impedance, at the motion's centre. The stiffness in the null space is a tenth of
  /// stiffness_Nm_per_rad.
  double stiffness_N_per_m{2000.0}, stiffness_Nm_per_rad_turn{200.0};
  double cartesian_damping_ratio{0.7};
  /// Relative error of the masses in the controller's model of the arm: 0.05 means 5 % too large; > -1.
  double mass_error{0.0};
  /// Share of the chain's friction that the controller compensates, 0 … 1.
  double friction_compensation{0.0};
  std::optional<FlexibleMountParams> mount{};  ///< none: the base is fixed
  int substeps{8};                             ///< integration steps per period, 1 … 1000
};

/// An arm with masses: M qdd + C qd + g = tau - friction + J^T F, integrated by Runge-Kutta of fourth order.
///
/// The controller computes these torques with its model of the arm, whose masses may be wrong. Each torque is
/// limited to its drive's maximum:
///
///     position             tau = RNEA(q, qd, w^2 (q_cmd - q) - 2 z w qd),  w = 2 pi bandwidth
///     joint impedance      tau = K (q_cmd - q) - D qd + C qd + g + tau_overlay
///     Cartesian impedance  tau = J^T (K x_error - D V + F_overlay) + (null space) + C qd + g
///
/// With exact masses, no friction and no external wrench, position control obeys ServoArm's equation, whose
/// closed form is the oracle in the tests. A wrench deflects the position-controlled arm by M^-1 J^T F / w^2.
///
/// The drives' gears are rigid: no elasticity between encoders and joints.
class DynamicArm final : public SimulatedArm {
 public:
  static constexpr int kMaxDeadCycles = 32;

  /// Starts at rest at q_start.
  /// @param chain  the arm's chain with masses and torque limits; its last link includes everything mounted
  /// on the flange
  /// @param gravity_B  [m/s^2]  @param p_FT_m  the motion's centre, in the flange's frame
  /// @throws std::invalid_argument naming the parameter, what was found and what is accepted.
  DynamicArm(const DynamicArmParams& params, const kinematics::ChainParams<7>& chain,
             const Vector3& gravity_B, const Vector3& p_FT_m, double period_s,
             const kinematics::JointVectorN<7>& q_start);

  void Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT override;

  [[nodiscard]] const kinematics::JointVectorN<7>& q() const OSTEON_RT override { return q_; }
  [[nodiscard]] const kinematics::JointVectorN<7>& qd() const OSTEON_RT override { return qd_; }
  [[nodiscard]] kinematics::JointVectorN<7> tau_measured_Nm() const OSTEON_RT override { return tau_; }
  [[nodiscard]] kinematics::JointVectorN<7> tau_external_Nm() const OSTEON_RT override;
  [[nodiscard]] Pose X_BBnow() const OSTEON_RT override;

 private:
  using Joints = kinematics::JointVectorN<7>;
  using Chain = kinematics::SerialChain<7>;

  [[nodiscard]] Joints Command(const ArmDrive& drive, const Joints& q, const Joints& qd) const OSTEON_RT;
  [[nodiscard]] Joints CartesianTorque(const ArmDrive& drive, const Joints& q,
                                       const Joints& qd) const OSTEON_RT;
  [[nodiscard]] Joints DriveTorque(const ArmDrive& drive, const Joints& q, const Joints& qd) const OSTEON_RT;
  [[nodiscard]] Joints Acceleration(const ArmDrive& drive, const Wrench& F_T_B, const Joints& tau_base,
                                    const Joints& q, const Joints& qd) const OSTEON_RT;

  DynamicArmParams params_;
  double period_s_;
  Chain arm_, model_;  ///< the true arm, and the controller's model of it
  Vector3 p_FT_m_;
  Joints torque_limit_Nm_, joint_damping_;
  double cartesian_damping_Ns_per_m_, cartesian_damping_Nms_per_rad_;
  std::optional<FlexibleMount> mount_;
  Joints q_, qd_, qdd_{Joints::Zero()}, tau_{Joints::Zero()};
  std::array<ArmDrive, kMaxDeadCycles + 1> delay_;
  std::size_t delay_size_, next_{0};
};

}  // namespace osteon::hil
