#pragma once

#include "base/marker.h"
#include "control/setup/pausable_clock.h"
#include "kinematics/chain_params.h"
#include "kinematics/serial_chain.h"

// How the arm gets to the start of the work: straight in joint space, slowly, while the path is permitted.

namespace osteon::control {

/// Reduced speed: limit of flange and tool while a person with an enabling switch is near (ISO 10218-1).
inline constexpr double kReducedSpeed_m_per_s = 0.25;

struct JointPathParams {
  double speed_share{0.2};         ///< of every joint's velocity limit, (0, 1]
  double acceleration_share{0.3};  ///< of every joint's acceleration limit, (0, 1]
  double tool_speed_m_per_s{0.2};  ///< of the tool's apex and of the flange, 0.001 … kReducedSpeed_m_per_s
  double pause_s{0.5};             ///< longest time from the switch's release to rest; 0.05 … 5
};

template <int N>
struct JointPathOutput {
  kinematics::JointVectorN<N> q{kinematics::JointVectorN<N>::Zero()};   ///< [rad]
  kinematics::JointVectorN<N> qd{kinematics::JointVectorN<N>::Zero()};  ///< [rad/s]
  double progress{0.0};  ///< 0 … 1, share of the path; never falls
  double rate{0.0};      ///< rate of the path's clock, 0 (paused) … 1
  bool done{false};      ///< at the goal, at rest
};

/// A straight motion in joint space from the present posture to a goal, one step per tick.
///
///     q = q_from + s (q_goal - q_from)       s = u^3 (10 - 15 u + 6 u^2), u = t / T in 0 … 1
///     qd = (q_goal - q_from) s'(u) r / T     t runs on a clock of rate r in 0 … 1 (PausableClock)
///
/// Velocity and acceleration vanish at both ends and are continuous on the path, as is r' in a pause. A pause
/// slows the clock, so the arm comes to rest on the line and later continues along it. T is long enough that
/// for every course of the clock, with d = |q_goal - q_from| of a joint, max s' = 15/8 and max|s''| =
/// 10/sqrt(3),
///
///     d max s' / T                             <= speed share × velocity
///     d (max|s''| / T^2 + max s' max|r'| / T)  <= acceleration share × acceleration
///     |dp/ds| s'(u) / T                        <= tool speed, p the apex and the flange's origin
///
/// The last bound is sampled at kSamples places. Between two of them the speed exceeds the samples by at most
/// half their distance times
///
///     |d/du (dp/ds s')| <= sum_ij d_i d_j R_max(i,j) max s'^2 + sum_i d_i R_i max|s''|
///
/// with R_i the sum of the arm's lengths beyond joint i. This is added: some percent of T, a fifth where all
/// joints cross their range. So T is never too short, for any arm.
///
/// No allocation after construction; same inputs, same bits. Source of s: Craig, Introduction to Robotics,
/// 7.3 (quintic polynomials).
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

  /// Starts a new path from an arm at rest. Evaluates kSamples postures, some 0.1 ms: not for every tick.
  /// @returns false, with nothing changed, if an end is not finite or beyond the arm's position limits.
  [[nodiscard]] bool StartPath(const Joints& q_from, const Joints& q_goal) OSTEON_RT;

  /// Advances the path by dt_s. @param permitted  e.g. the enabling switch is held
  /// @pre StartPath has returned true
  [[nodiscard]] JointPathOutput<N> Step(double dt_s, bool permitted) OSTEON_RT;

  /// T [s]. Without a pause the path takes pause_s / 3 longer, because the clock starts from rest.
  [[nodiscard]] double duration_s() const OSTEON_RT { return duration_s_; }
  [[nodiscard]] const Joints& q_goal() const OSTEON_RT { return q_goal_; }

 private:
  [[nodiscard]] double JointDuration(const Joints& way) const OSTEON_RT;
  [[nodiscard]] double ToolDuration(const Joints& way) const OSTEON_RT;

  JointPathParams params_;
  kinematics::SerialChain<N> chain_;
  Vector3 p_FT_m_;
  Joints reach_m_{Joints::Zero()};  ///< R_i, as far as the tool's apex and beyond the flange

  Joints q_from_{Joints::Zero()}, q_goal_{Joints::Zero()};
  double duration_s_{0.0};
  PausableClock clock_;
  double t_s_{0.0};
  double progress_{0.0};
};

}  // namespace osteon::control
