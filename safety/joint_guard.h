#pragma once

#include <array>

#include "base/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::safety {

/// Limits of each joint, and the distances that a step keeps from them.
struct JointGuardParams {
  /// The arm's own limits; lower < upper, velocity and acceleration > 0. A six-axis arm uses the first six.
  std::array<kinematics::JointLimits, 7> limits{};
  double position_margin_rad{0.0174532925199433};  ///< distance kept from each position limit (1 deg); >= 0
  double speed_share{0.9};                         ///< usable share of the velocity limit, (0, 1]
  double jump_rad{0.1};  ///< a larger step of a joint is treated as a jump to another branch of the inverse
                         ///< kinematics; > 0
};

/// Keeps a joint step within position, speed and step limits by scaling the steps of all joints with one
/// factor. The arm then moves more slowly along the same path; clipping a single joint would change the
/// tool's direction.
///
/// Toward a position limit joint i may move at BrakingSpeed(distance, acceleration_i): one tick's motion v dt
/// and the braking after it then end before the limit.
/// @tparam N number of joints, 6 or 7
template <int N>
class JointGuard {
 public:
  using Joints = kinematics::JointVectorN<N>;

  /// @throws std::invalid_argument if a value is out of range, naming the joint.
  explicit JointGuard(const JointGuardParams& params);

  struct Result {
    Joints step{Joints::Zero()};  ///< [rad]
    double share{1.0};            ///< factor that was applied to the wanted step, 0 … 1
    bool jump{false};      ///< a joint's wanted step was beyond jump_rad, or not finite; step is then zero
    bool violated{false};  ///< q is outside the arm's own position limits
  };
  /// Scales the wanted step of a tick that starts at the joint positions q.
  [[nodiscard]] Result Limit(const Joints& q, const Joints& wanted_step_rad, double dt_s) const OSTEON_RT;

 private:
  JointGuardParams params_;
};

extern template class JointGuard<6>;
extern template class JointGuard<7>;

}  // namespace osteon::safety
