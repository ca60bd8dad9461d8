#pragma once

#include "base/marker.h"
#include "control/setup/pausable_clock.h"
#include "kinematics/chain_params.h"
#include "kinematics/serial_chain.h"

// The path on which the arm moves to the start of the work: straight in joint space, slowly, and only while
// motion is permitted.

namespace osteon::control {

/// Reduced speed: limit for flange and tool while a person with an enabling switch is near the arm (ISO
/// 10218-1).
inline constexpr double kReducedSpeed_m_per_s = 0.25;

struct JointPathParams {
  double speed_share{0.2};         ///< share of every joint's velocity limit that the path uses, (0, 1]
  double acceleration_share{0.3};  ///< share of every joint's acceleration limit that the path uses, (0, 1]
  /// speed limit of the tool's apex and of the flange, 0.001 … kReducedSpeed_m_per_s
  double tool_speed_m_per_s{0.2};
  double pause_s{0.5};  ///< longest time from the switch's release to rest; 0.05 … 5
};

template <int N>
struct JointPathOutput {
  kinematics::JointVectorN<N> q{kinematics::JointVectorN<N>::Zero()};   ///< [rad]
  kinematics::JointVectorN<N> qd{kinematics::JointVectorN<N>::Zero()};  ///< [rad/s]
  double progress{0.0};  ///< share of the path that is done, 0 … 1; never falls
  double rate{0.0};      ///< rate of the path's clock, 0 (paused) … 1
  bool done{false};      ///< the path is at the goal, at rest
};

/// A straight motion in joint space from the present posture to a goal, with one step per tick.
///
///     q = q_from + s (q_goal - q_from)       s = u^3 (10 - 15 u + 6 u^2), u = t / T in 0 … 1
///     qd = (q_goal - q_from) s'(u) r / T     t runs on a clock of rate r in 0 … 1 (PausableClock)
///
/// Velocity and acceleration are zero at both ends and continuous in between. A pause slows the clock down,
/// with continuous r', so the arm comes to rest on the line and later continues along it. T is long enough
/// for every course of the clock: with d = |q_goal - q_from| of a joint, max s' = 15/8 and max|s''| =
/// 10/sqrt(3),
///
///     d max s' / T                             <= speed share × velocity
///     d (max|s''| / T^2 + max s' max|r'| / T)  <= acceleration share × acceleration
///     |dp/ds| s'(u) / T                        <= tool speed, p the apex and the flange's origin
///
/// The last condition is evaluated at kSamples + 1 samples of u. Between two samples, the speed exceeds the
/// samples' speed by at most half the samples' distance times
///
///     |d/du (dp/ds s')| <= sum_ij d_i d_j R_max(i,j) max s'^2 + sum_i d_i R_i max|s''|
///
/// with the sum R_i of the arm's lengths beyond joint i. This is added to the largest sample. It makes T
/// longer by some percent, and by a fifth if all joints cross their whole range. So T is never too short, for
/// any arm.
///
/// Allocates no memory after construction. The same inputs give the same bits. Source of s: Craig,
/// Introduction to Robotics, 7.3 (quintic polynomials).
/// @tparam N number of joints, 6 or 7
template <int N>
class JointPath {
 public:
  using Joints = kinematics::JointVectorN<N>;
  static constexpr int kSamples = 512;

  /// @param chain  geometry and limits of the arm
  /// @param p_FT_m  the tool's apex in the flange's frame
  /// @throws std::invalid_argument naming parameter or joint, what was found and what is accepted.
  JointPath(const JointPathParams& params, const kinematics::ChainParams<N>& chain, const Vector3& p_FT_m);

  /// Starts a new path. The arm must be at rest. Evaluates kSamples + 1 postures, which takes some 0.1 ms:
  /// not for every tick.
  /// @returns false, with nothing changed, if an end is not finite or beyond the arm's position limits.
  [[nodiscard]] bool StartPath(const Joints& q_from, const Joints& q_goal) OSTEON_RT;

  /// Advances the path by dt_s. @param permitted  e.g. the enabling switch is held
  /// @pre StartPath has returned true
  [[nodiscard]] JointPathOutput<N> Step(double dt_s, bool permitted) OSTEON_RT;

  /// T [s]. Even without a pause, the path takes pause_s / 3 longer than T, because the clock starts from
  /// rest.
  [[nodiscard]] double duration_s() const OSTEON_RT { return duration_s_; }
  [[nodiscard]] const Joints& q_goal() const OSTEON_RT { return q_goal_; }

 private:
  [[nodiscard]] double JointDuration(const Joints& way) const OSTEON_RT;
  [[nodiscard]] double ToolDuration(const Joints& way) const OSTEON_RT;

  JointPathParams params_;
  kinematics::SerialChain<N> chain_;
  Vector3 p_FT_m_;
  Joints reach_m_{Joints::Zero()};  ///< R_i, including the distance from the flange to the apex

  Joints q_from_{Joints::Zero()}, q_goal_{Joints::Zero()};
  double duration_s_{0.0};
  PausableClock clock_;
  double t_s_{0.0};
  double progress_{0.0};
};

}  // namespace osteon::control
