#pragma once

#include "base/marker.h"
#include "control/ports.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"
#include "simulation/fidelity/arm_level.h"

namespace osteon::hil {

/// Model of the arm's motion. kKinematic: the arm reaches each commanded position one cycle later. kServo:
/// ServoArm. kDynamic: DynamicArm.
using ArmLevel = simulation::ArmFidelity;

/// The command to the arm's controller for one cycle.
struct ArmDrive {
  control::ControlMode control{control::ControlMode::kPosition};           ///< kNone is treated as kPosition
  kinematics::JointVectorN<7> q_cmd{kinematics::JointVectorN<7>::Zero()};  ///< [rad]
  /// Torque overlay in joint impedance.
  kinematics::JointVectorN<7> tau_Nm{kinematics::JointVectorN<7>::Zero()};
  Wrench F_T_B{};  ///< wrench overlay in Cartesian impedance: at the motion's centre (the tool), in B
};

/// A simulated arm with seven joints that follow commands. One writing thread; deterministic; Step() does not
/// allocate.
class SimulatedArm {
 public:
  virtual ~SimulatedArm() = default;

  /// Advances by one period; command and wrench are those at the period's beginning.
  /// @param F_T_B  external wrench on the tool, at the motion's centre, in B
  virtual void Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT = 0;

  [[nodiscard]] virtual const kinematics::JointVectorN<7>& q() const OSTEON_RT = 0;   ///< [rad]
  [[nodiscard]] virtual const kinematics::JointVectorN<7>& qd() const OSTEON_RT = 0;  ///< [rad/s]
  /// The joints' torque sensors [N·m]; zero if the model has no torques.
  [[nodiscard]] virtual kinematics::JointVectorN<7> tau_measured_Nm() const OSTEON_RT = 0;
  /// The controller's estimate of the external joint torques [N·m]: J^T F of the present wrench, plus the
  /// error of the controller's model of the arm.
  [[nodiscard]] virtual kinematics::JointVectorN<7> tau_external_Nm() const OSTEON_RT = 0;
  /// Present pose of the base, relative to its pose at rest (the mount may be flexible). Joints and flange
  /// are relative to the present base.
  [[nodiscard]] virtual Pose X_BBnow() const OSTEON_RT { return Pose::Identity(); }
};

}  // namespace osteon::hil
