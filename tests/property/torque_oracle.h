#pragma once

#include "control/ports.h"
#include "kinematics/chain_params.h"

// An oracle for the torques on an arm's joints that shares no code with the loop's dynamics: it computes
// gravity's torques as the slope of the potential energy.

namespace osteon::property {

/// Torques that hold the arm at rest [N·m], dU/dq by central differences; its base stands upright.
[[nodiscard]] control::JointArray GravityByEnergy(const kinematics::ChainParams<7>& arm,
                                                  const control::JointArray& q);

/// Follows the external torques on the joints, message by message.
class TorqueOracle {
 public:
  /// The torque [N·m] by which some joint will exceed its limit one message from now, if its torque keeps
  /// changing at the same rate; gravity counts as a load even if it relieves the joint. Negative: no joint
  /// will exceed its limit. NaN if an external torque is not finite.
  double Beyond_Nm(const kinematics::ChainParams<7>& arm, const control::JointArray& q,
                   const control::JointArray& tau_external_Nm);

 private:
  control::JointArray before_Nm_{};
  bool has_before_{false};
};

}  // namespace osteon::property
