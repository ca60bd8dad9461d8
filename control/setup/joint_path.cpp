#include "control/setup/joint_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "base/parameter_check.h"
#include "kinematics/chain_reach.h"

namespace osteon::control {
namespace {

constexpr double kMaxSlope = 15.0 / 8.0;                // maximum of s', at u = 1/2
constexpr double kMaxCurvature = 5.773502691896257645;  // 10 / sqrt(3), maximum of |s''|

// s'(u)
double Slope(double u) OSTEON_RT { return 30.0 * u * u * (1.0 - u) * (1.0 - u); }

// s(u). Computed from the nearer end, which is more accurate, so that the path ends without a step.
double Share(double u) OSTEON_RT {
  const auto from_zero = [](double x) { return x * x * x * (10.0 - x * (15.0 - 6.0 * x)); };
  return u < 0.5 ? from_zero(u) : 1.0 - from_zero(1.0 - u);
}

JointPathParams Checked(const JointPathParams& params) {
  const base::ParameterCheck require("joint path ");
  require("speed_share", params.speed_share, 0.001, 1.0);
  require("acceleration_share", params.acceleration_share, 0.001, 1.0);
  require("tool_speed_m_per_s", params.tool_speed_m_per_s, 0.001, kReducedSpeed_m_per_s);
  require("pause_s", params.pause_s, 0.05, 5.0);
  return params;
}

}  // namespace

template <int N>
JointPath<N>::JointPath(const JointPathParams& params, const kinematics::ChainParams<N>& chain,
                        const Vector3& p_FT_m)
    : params_(Checked(params)), chain_(chain), p_FT_m_(p_FT_m), clock_(params.pause_s) {
  if (!p_FT_m.allFinite()) throw std::invalid_argument("joint path p_FT_m: accepted a finite position");
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const kinematics::JointLimits& limits = chain.joints[i].limits;
    const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
    if (!positive(limits.velocity_rad_per_s) || !positive(limits.acceleration_rad_per_s2))
      throw std::invalid_argument("joint path A" + std::to_string(i + 1) + ": found velocity " +
                                  base::NumberText(limits.velocity_rad_per_s) + " rad/s, acceleration " +
                                  base::NumberText(limits.acceleration_rad_per_s2) +
                                  " rad/s^2, accepted > 0 for both");
  }
  reach_m_ = kinematics::ReachBeyond(chain).array() + p_FT_m.norm();
}

// Shortest duration T [s] with which every joint keeps its share of speed and acceleration, even if the path
// is paused.
template <int N>
double JointPath<N>::JointDuration(const Joints& way) const OSTEON_RT {
  const double pause_rate = kMaxSlope * PausableClock::MaxRateSpeed(params_.pause_s);
  double duration_s = 0.0;
  for (int i = 0; i < N; ++i) {
    const kinematics::JointLimits& limits = chain_.params().joints[static_cast<std::size_t>(i)].limits;
    const double d = std::abs(way[i]);
    const double speed = params_.speed_share * limits.velocity_rad_per_s,
                 acceleration = params_.acceleration_share * limits.acceleration_rad_per_s2;
    // positive root of acceleration T^2 - d pause_rate T - d max|s''| = 0
    const double b = d * pause_rate;
    const double acceleration_s =
        (b + std::sqrt(b * b + 4.0 * acceleration * d * kMaxCurvature)) / (2.0 * acceleration);
    duration_s = std::max({duration_s, kMaxSlope * d / speed, acceleration_s});
  }
  return duration_s;
}

// Shortest duration [s] with which the apex and the flange's origin keep the tool's speed limit.
template <int N>
double JointPath<N>::ToolDuration(const Joints& way) const OSTEON_RT {
  double max_m = 0.0;  // largest |dp/du|
  typename kinematics::SerialChain<N>::Posture posture;
  for (int k = 0; k <= kSamples; ++k) {
    const double u = static_cast<double>(k) / kSamples;
    chain_.ComputePosture(q_from_ + Share(u) * way, posture);
    const Vector3 p_BT = posture.X_BF * p_FT_m_;
    // velocity of the apex, and angular velocity, per unit of s
    Vector3 v = Vector3::Zero(), w = Vector3::Zero();
    for (int i = 0; i < N; ++i) {
      const Vector3 turn = way[i] * posture.axis_B(i);
      w += turn;
      v += turn.cross(p_BT - posture.p_BL[static_cast<std::size_t>(i)]);
    }
    const Vector3 v_flange = v + w.cross(posture.X_BF.translation() - p_BT);
    max_m = std::max(max_m, Slope(u) * std::max(v.norm(), v_flange.norm()));
  }
  double first_m = 0.0, second_m = 0.0;  // upper bounds of |dp/ds| and of |d²p/ds²|
  double inner = 0.0;                    // sum of the rotations of the joints nearer to the base [rad]
  for (int i = 0; i < N; ++i) {
    const double d = std::abs(way[i]);
    first_m += d * reach_m_[i];
    second_m += d * (d + 2.0 * inner) * reach_m_[i];
    inner += d;
  }
  const double change_m = second_m * kMaxSlope * kMaxSlope + first_m * kMaxCurvature;
  return (max_m + change_m / (2.0 * kSamples)) / params_.tool_speed_m_per_s;
}

template <int N>
bool JointPath<N>::StartPath(const Joints& q_from, const Joints& q_goal) OSTEON_RT {
  for (int i = 0; i < N; ++i) {
    const kinematics::JointLimits& limits = chain_.params().joints[static_cast<std::size_t>(i)].limits;
    for (const double q : {q_from[i], q_goal[i]})
      if (!(q >= limits.lower_rad && q <= limits.upper_rad)) return false;
  }
  q_from_ = q_from;
  q_goal_ = q_goal;
  const Joints way = q_goal - q_from;
  duration_s_ = std::max(JointDuration(way), ToolDuration(way));
  clock_ = PausableClock(params_.pause_s);
  t_s_ = 0.0;
  progress_ = 0.0;
  return true;
}

template <int N>
JointPathOutput<N> JointPath<N>::Step(double dt_s, bool permitted) OSTEON_RT {
  t_s_ += clock_.Step(dt_s, permitted);
  JointPathOutput<N> out;
  out.rate = clock_.rate();
  if (!(t_s_ < duration_s_)) {
    out.q = q_goal_;  // without rounding error
    out.progress = progress_ = 1.0;
    out.done = true;
    return out;
  }
  const double u = t_s_ / duration_s_;
  const Joints way = q_goal_ - q_from_;
  progress_ = std::max(progress_, Share(u));  // rounding must not let it fall
  out.progress = progress_;
  out.q = q_from_ + progress_ * way;
  out.qd = (Slope(u) * clock_.rate() / duration_s_) * way;
  return out;
}

template class JointPath<6>;
template class JointPath<7>;

}  // namespace osteon::control
