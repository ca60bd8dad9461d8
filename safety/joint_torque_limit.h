#pragma once

#include "base/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::safety {

/// Joint torques that an arm can hold in addition to its own weight. Gravity may help in one direction, but
/// that is not relied on: its torque is subtracted in both directions.
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

  /// Largest factor, 0 … 1, by which the torques can be scaled so that every joint holds its own. One factor
  /// for all joints keeps the direction of their force at the tool. 0 if a torque is not finite.
  [[nodiscard]] double MaxScale(const Joints& gravity_Nm, const Joints& tau_Nm) const OSTEON_RT;

  /// True if the external torques on the joints, extrapolated linearly, will exceed what the joints can hold
  /// one message from now:
  ///
  ///     |tau_i| + |tau_i - tau_i before| > room_i
  ///
  /// Call once per message, with the arm's estimate. An estimate that is not finite gives false, and the next
  /// one counts as the first, without a change.
  [[nodiscard]] bool PredictOverload(const Joints& gravity_Nm, const Joints& tau_external_Nm) OSTEON_RT;

 private:
  Joints max_Nm_;
  Joints before_Nm_{Joints::Zero()};
  bool has_before_{false};  // before_Nm_ is the previous message's
};

extern template class JointTorqueLimit<7>;

}  // namespace osteon::safety
