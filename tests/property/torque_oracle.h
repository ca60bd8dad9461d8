#pragma once

#include "control/ports.h"
#include "kinematics/chain_params.h"

// What an arm's joints hold, known apart from the loop's dynamics: gravity's torques as the slope of the
// potential energy.

namespace osteon::property {

/// Torques that hold the arm at rest [N·m], dU/dq by central differences; its base stands upright.
[[nodiscard]] control::JointArray GravityByEnergy(const kinematics::ChainParams<7>& arm,
                                                  const control::JointArray& q);

/// Follows what acts on the joints from outside, message by message.
class TorqueOracle {
 public:
  /// By how much [N·m] some joint will bear more than it holds a message from now, gravity's help not
  /// counted, where its torque goes on as it came; negative: none will. NaN where the estimate is no number.
  double Beyond_Nm(const kinematics::ChainParams<7>& arm, const control::JointArray& q,
                   const control::JointArray& tau_external_Nm);

 private:
  control::JointArray before_Nm_{};
  bool has_before_{false};
};

}  // namespace osteon::property
