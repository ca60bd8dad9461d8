#pragma once

#include "control/ports.h"
#include "control/rt/marker.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"
#include "simulation/fidelity/arm_level.h"

namespace osteon::hil {

/// kKinematic is where it was told to be, a cycle later; kServo is ServoArm, kDynamic DynamicArm.
using ArmLevel = simulation::ArmFidelity;

/// What the arm's controller is told for a cycle.
struct ArmDrive {
  control::ControlMode control{control::ControlMode::kPosition};            ///< kNone counts as kPosition
  kinematics::JointVectorN<7> q_cmd{kinematics::JointVectorN<7>::Zero()};   ///< [rad]
  kinematics::JointVectorN<7> tau_Nm{kinematics::JointVectorN<7>::Zero()};  ///< on top, in joint impedance
  Wrench F_T_B{};  ///< on top, in Cartesian impedance: at the motion's centre (the tool), in B
};

/// Seven joints that follow commands. One writer; deterministic; Step() does not allocate.
class SimulatedArm {
 public:
  virtual ~SimulatedArm() = default;

  /// Advances by one period, with what is told and what presses on the tool at its beginning.
  /// @param F_T_B  wrench that acts on the tool from outside, at the motion's centre, in B
  virtual void Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT = 0;

  [[nodiscard]] virtual const kinematics::JointVectorN<7>& q() const OSTEON_RT = 0;   ///< [rad]
  [[nodiscard]] virtual const kinematics::JointVectorN<7>& qd() const OSTEON_RT = 0;  ///< [rad/s]
  /// What the joints' torque sensors read [N·m]; zero where the level has no torques.
  [[nodiscard]] virtual kinematics::JointVectorN<7> tau_measured_Nm() const OSTEON_RT = 0;
  /// The controller's estimate of what the outside exerts on the joints [N·m]: J^T F of the present wrench,
  /// and what its model of the arm gets wrong.
  [[nodiscard]] virtual kinematics::JointVectorN<7> tau_external_Nm() const OSTEON_RT = 0;
  /// Where the base is, seen from where it stands at rest; joints and flange are measured from it.
  [[nodiscard]] virtual Pose X_BBnow() const OSTEON_RT { return Pose::Identity(); }
};

}  // namespace osteon::hil
