#pragma once

#include "control/rt/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::safety {

/// What an arm's joints hold beside the arm itself, each by its own torque. Gravity's help is not counted on:
/// what it takes is taken off either side.
///
///     room_i = max(0, tau_max_i - |g_i|)
///
/// @tparam N number of joints
template <int N>
class JointTorqueLimit {
 public:
  using Joints = kinematics::JointVectorN<N>;

  /// @param most_Nm  tau_max, the arm's own
  /// @throws std::invalid_argument where one is not positive, naming the joint.
  explicit JointTorqueLimit(const Joints& most_Nm);

  /// 0 … 1: the share of torques that the joints hold; all of them by one factor, so that what they are for
  /// keeps its direction. 0 where one is not finite.
  [[nodiscard]] double Share(const Joints& gravity_Nm, const Joints& tau_Nm) const OSTEON_RT;

  /// True where what acts on the joints from outside will be beyond what they hold one message from now,
  /// going on as it came:
  ///
  ///     |tau_i| + |tau_i - tau_i before| > room_i
  ///
  /// Once a message, with the arm's estimate; one that is not finite says nothing, and is forgotten.
  [[nodiscard]] bool Check(const Joints& gravity_Nm, const Joints& tau_external_Nm) OSTEON_RT;

 private:
  Joints most_Nm_;
  Joints before_Nm_{Joints::Zero()};
  bool has_before_{false};
};

extern template class JointTorqueLimit<7>;

}  // namespace osteon::safety
