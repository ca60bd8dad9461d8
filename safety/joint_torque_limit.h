#pragma once

#include "base/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::safety {

/// Joint torques that an arm can hold in addition to its own weight. Gravity may reduce the needed torque in
/// one direction, but this is not relied on: its torque is subtracted in both directions.
///
///     room_i = max(0, tau_max_i - |g_i|)
///
/// @tparam N number of joints
template <int N>
class JointTorqueLimit {
 public:
  using Joints = kinematics::JointVectorN<N>;

  /// @param max_Nm  tau_max, the arm's own
  /// @throws std::invalid_argument if a torque is not positive, naming the joint.
  explicit JointTorqueLimit(const Joints& max_Nm);

  /// Largest factor s, 0 … 1, for which every joint can hold s times its torque. One factor
  /// for all joints keeps the direction of their force at the tool. 0 if a torque is not finite.
  [[nodiscard]] double MaxScale(const Joints& gravity_Nm, const Joints& tau_Nm) const OSTEON_RT;

  /// Whether the external torque on a joint, extrapolated linearly to the next message, exceeds what the
  /// joint can hold:
  ///
  ///     |tau_i| + |tau_i - tau_i before| > room_i
  ///
  /// Call once per message, with the external torques as estimated by the arm. For an estimate that is not
  /// finite, returns false; the next estimate is then treated like the first, for which no change is known.
  [[nodiscard]] bool PredictOverload(const Joints& gravity_Nm, const Joints& tau_external_Nm) OSTEON_RT;

 private:
  Joints max_Nm_;
  Joints before_Nm_{Joints::Zero()};
  bool has_before_{false};  // before_Nm_ has the torques of the previous message
};

extern template class JointTorqueLimit<7>;

}  // namespace osteon::safety
