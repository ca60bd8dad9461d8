#include "kinematics/differential_inverse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/parameter_check.h"
#include "kinematics/braking_speed.h"
#include "kinematics/jacobi_svd.h"

namespace osteon::kinematics {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kFlat = 1e-9;  // a component of the null direction up to this counts as zero
// If the last singular value is below this fraction of the largest one, the decomposition cannot separate its
// direction from the null direction.
constexpr double kUnresolved = 1e-9;
// Curvature |d sigma / d y| [m/rad] of a singular direction. From this value on, the zone has its full width
// and motion that makes sigma larger is not damped. For a smaller curvature the zone is narrower and such
// motion is damped, in proportion.
constexpr double kReturning_m = 0.05;
// times min_damping_m: without curvature, larger singular values than this are not damped
constexpr double kDampedUpTo = 4.0;
// number of ticks in which an arm that is within singular_margin_rad is moved back out
constexpr double kReturnTicks = 10.0;
// speed limit of the null motion that relieves joint i, per unit of |n_i|
constexpr double kRelief_rad_per_s = 4.0;
constexpr double kMaxRelief_rad_per_s = 100.0;  // largest such limit: above any joint's speed limit
constexpr double kTiny = 1e-12;                 // smallest divisor; a curvature up to this counts as zero
// factor on a speed limit, so that rounding cannot exceed the limit
constexpr double kRoundDown = 1.0 - 1e-12;
constexpr double kActs = 1e-9;  // a motion that loses a smaller share counts as not limited

// Acceleration J' y of the tool at constant joint velocity y, where J' is the time derivative of J. With v_i,
// w_i the linear and angular part of column i of J, and W_i the sum of w_j y_j over the joints before i,  v'
// = sum (2 W_i + w_i y_i) x v_i y_i   and   w' = sum W_i x w_i y_i.
template <int N>
Vector6 Curvature(const JacobianN<N>& J, const JointVectorN<N>& y) {
  Vector3 W = Vector3::Zero(), v_dot = Vector3::Zero(), w_dot = Vector3::Zero();
  for (int i = 0; i < N; ++i) {
    const Vector3 v = y[i] * J.template block<3, 1>(0, i), w = y[i] * J.template block<3, 1>(3, i);
    v_dot += (2.0 * W + w).cross(v);
    w_dot += W.cross(w);
    W += w;
  }
  Vector6 result;
  result << v_dot, w_dot;
  return result;
}

// Gradient of a singular value with respect to the joint positions: u·(dJ/dq_j) c for each joint j, with u
// and c the left and right singular vectors (c is the argument v). Column J_i of J has the linear part v_i
// and the angular part w_i, and dJ_i/dq_j is [w_j x v_i; w_j x w_i] if j <= i, else [w_i x v_j; 0]. The sum
// over i is
//
//     u_v·(W_j x v_j + w_j x V_j) + u_w·(w_j x X_j)
//
// W_j is the sum of c_i w_i over the joints before j, V_j that of c_i v_i from j on, X_j that of c_i w_i
// after j.
template <int N>
JointVectorN<N> SingularValueGradient(const JacobianN<N>& J, const Vector6& u, const JointVectorN<N>& v) {
  const Vector3 u_v = u.head<3>(), u_w = u.tail<3>();
  Vector3 W_before = Vector3::Zero(), V_from = J.template topRows<3>() * v,
          W_after = J.template bottomRows<3>() * v;
  JointVectorN<N> gradient;
  for (int j = 0; j < N; ++j) {
    const Vector3 v_j = J.template block<3, 1>(0, j), w_j = J.template block<3, 1>(3, j);
    W_after -= v[j] * w_j;
    gradient[j] = u_v.dot(W_before.cross(v_j) + w_j.cross(V_from)) + u_w.dot(w_j.cross(W_after));
    W_before += v[j] * w_j;
    V_from -= v[j] * v_j;
  }
  return gradient;
}

// Returns the twist with its angular part multiplied by the turning length.
Vector6 Scaled(Vector6 twist, double length_m) {
  twist.tail<3>() *= length_m;
  return twist;
}

// In an exactly singular posture two joint directions give no tool motion: v (column 5) and n (column 6),
// which the decomposition mixes at will. Turns them within their plane, so that column 5 is the direction
// with the larger curvature along u_min.
template <int N>
void SeparateByCurvature(const JacobianN<N>& J, const Vector6& u_min,
                         Eigen::Matrix<double, N, N>& directions) {
  const JointVectorN<N> v = directions.col(5), n = directions.col(6);
  // the curvature is a quadratic form on the plane of v and n: find its principal axes
  const double vv = u_min.dot(Curvature<N>(J, v)), nn = u_min.dot(Curvature<N>(J, n));
  const double vn = 0.5 * (u_min.dot(Curvature<N>(J, JointVectorN<N>(v + n))) - vv - nn);
  double angle = 0.5 * std::atan2(2.0 * vn, vv - nn);
  if (vv + nn < 0.0) angle += 0.5 * std::numbers::pi;
  directions.col(5) = std::cos(angle) * v + std::sin(angle) * n;
  directions.col(6) = std::cos(angle) * n - std::sin(angle) * v;
}

// Stores in `out` the limit that reduced a twist of the given length the most: the singularity, or the joint
// limit that `out` already names.
template <int N>
void NameLimit(double length_m_per_s, MotionOutput<N>& out) {
  const double lost_share = length_m_per_s > 0.0 ? std::min(1.0, out.lost_m_per_s / length_m_per_s) : 0.0;
  const double worst = std::max({lost_share, 1.0 - out.share, 1.0 - out.change_share});
  if (worst < kActs) {
    out.limit = MotionLimit::kNone;
    out.joint = -1;
  } else if (worst == lost_share) {
    out.limit = MotionLimit::kSingularity;
    out.joint = -1;
  }
}

}  // namespace

const char* Name(MotionLimit limit) noexcept {
  switch (limit) {
    case MotionLimit::kNone:
      return "none";
    case MotionLimit::kSingularity:
      return "singularity";
    case MotionLimit::kPosition:
      return "joint position";
    case MotionLimit::kVelocity:
      return "joint velocity";
    case MotionLimit::kAcceleration:
      return "joint acceleration";
  }
  return "none";
}

template <int N>
DifferentialInverse<N>::DifferentialInverse(const DifferentialInverseParams<N>& params) : params_(params) {
  const base::ParameterCheck require("");
  require("position_margin_rad", params.position_margin_rad, params.position_margin_rad >= 0.0, ">= 0");
  require("speed_share", params.speed_share, params.speed_share > 0.0 && params.speed_share <= 1.0, "0 … 1");
  require("acceleration_share", params.acceleration_share, params.acceleration_share > 0.0, "> 0");
  require("turning_length_m", params.turning_length_m, params.turning_length_m > 0.0, "> 0");
  require("min_damping_m", params.min_damping_m, params.min_damping_m > 0.0, "> 0");
  require("singular_zone_m", params.singular_zone_m,
          params.singular_zone_m >= kDampedUpTo * params.min_damping_m, ">= 4 min_damping_m");
  require("singular_margin_rad", params.singular_margin_rad, params.singular_margin_rad >= 0.0, ">= 0");
  require("singular_speed_share", params.singular_speed_share,
          params.singular_speed_share > 0.0 && params.singular_speed_share <= 1.0, "0 … 1");
  require("null_speed_rad_per_s", params.null_speed_rad_per_s, params.null_speed_rad_per_s >= 0.0, ">= 0");
  require("null_acceleration_share", params.null_acceleration_share,
          params.null_acceleration_share > 0.0 && params.null_acceleration_share <= 1.0, "0 … 1");
  for (int i = 0; i < N; ++i) {
    const JointLimits& limit = params.limits[static_cast<std::size_t>(i)];
    const std::string joint = "joint A" + std::to_string(i + 1) + " ";
    require(joint + "velocity [rad/s]", limit.velocity_rad_per_s, limit.velocity_rad_per_s > 0.0, "> 0");
    require(joint + "acceleration [rad/s^2]", limit.acceleration_rad_per_s2,
            limit.acceleration_rad_per_s2 > 0.0, "> 0");
    low_rad_[i] = limit.lower_rad + params.position_margin_rad;
    high_rad_[i] = limit.upper_rad - params.position_margin_rad;
    require(joint + "range within the margin [rad]", high_rad_[i] - low_rad_[i], high_rad_[i] > low_rad_[i],
            "> 0");
    speed_rad_per_s_[i] = params.speed_share * limit.velocity_rad_per_s * kRoundDown;
    acceleration_rad_per_s2_[i] = params.acceleration_share * limit.acceleration_rad_per_s2;
    braking_time_s_ = std::max(braking_time_s_, speed_rad_per_s_[i] / limit.acceleration_rad_per_s2);
  }
}

template <int N>
MotionOutput<N> DifferentialInverse<N>::Step(const MotionInput<N>& in) const OSTEON_RT {
  MotionOutput<N> out;
  Vector6 V;
  V << in.V_BT.v, in.V_BT.w;
  if (!in.J.allFinite() || !V.allFinite() || !in.q.allFinite() || !in.qd_before.allFinite() ||
      !in.qd_null.allFinite() || !(in.dt_s > 0.0)) {
    out.share = out.change_share = 0.0;
    out.finite = false;
    return out;
  }

  // singular value decomposition of J, with rotations scaled by the turning length
  JacobianN<N> J = in.J;
  J.template bottomRows<3>() *= params_.turning_length_m;
  JacobianSvd<N> svd = ComputeJacobianSvd<N>(J, in.U_before);
  out.U = svd.U;
  const Vector6 u_min = Scaled(svd.U.col(5), params_.turning_length_m);
  if constexpr (N > 6)
    if (svd.sigma[5] < kUnresolved * svd.sigma[0]) SeparateByCurvature<N>(in.J, u_min, svd.V);
  out.sigma_min_m = svd.sigma[5];
  out.sigma_gradient_m = SingularValueGradient<N>(in.J, u_min, svd.V.col(5));

  // The tool's path is curved, so its mean velocity over the tick is J qd plus half a tick of J' qd. Subtract
  // this second part from the wanted twist, so that the mean velocity is the wanted one. For this correction
  // qd is computed without limits.
  JointVectorN<N> qd_free = in.qd_before;
  for (int k = 0; k < 6; ++k) {
    if (svd.sigma[k] < params_.singular_zone_m) continue;
    const double a = svd.U.col(k).dot(Scaled(V, params_.turning_length_m));
    qd_free += (a / svd.sigma[k] - svd.V.col(k).dot(in.qd_before)) * svd.V.col(k);
  }
  V -= 0.5 * in.dt_s * Curvature<N>(in.J, qd_free);
  const Vector6 V_scaled = Scaled(V, params_.turning_length_m);
  const JointVectorN<N> task = DampedTask(in, svd, V_scaled, out);

  // null space, limits
  JointVectorN<N> n = JointVectorN<N>::Zero();
  if constexpr (N > 6) n = svd.V.col(6);
  out.null_direction = n;
  const Box box = ComputeSpeedBox(in.q, in.dt_s);
  ScaleIntoBox(box, task, n, LimitedNullSpeed(n, in), out);
  if (!in.ignore_acceleration) LimitChange(box, in.qd_before, in.dt_s, out);
  NameLimit(V_scaled.norm(), out);
  const Vector6 V_out = in.J * out.qd + 0.5 * in.dt_s * Curvature<N>(in.J, out.qd);
  out.V_BT = {.v = V_out.head<3>(), .w = V_out.tail<3>()};
  return out;
}

// Joint velocity for the wanted twist: exact along directions whose singular value is at least
// singular_zone_m, damped along the others.
template <int N>
JointVectorN<N> DifferentialInverse<N>::DampedTask(const MotionInput<N>& in, const JacobianSvd<N>& svd,
                                                   const Eigen::Matrix<double, 6, 1>& V_scaled,
                                                   MotionOutput<N>& out) const OSTEON_RT {
  JointVectorN<N> task = JointVectorN<N>::Zero();
  const double length = V_scaled.norm();
  double lost_squared = 0.0;
  for (int k = 0; k < 6; ++k) {
    const Vector6 u = svd.U.col(k);
    const JointVectorN<N> v = svd.V.col(k);
    const double sigma = svd.sigma[k], a = u.dot(V_scaled);
    if (sigma >= params_.singular_zone_m) {
      task += (a / sigma) * v;
      continue;
    }
    const double curvature_m = Scaled(u, params_.turning_length_m).dot(Curvature<N>(in.J, v));
    const DampedSpeed y = ComputeDampedSpeed(
        {.v = v, .sigma_m = sigma, .curvature_m = curvature_m, .a_m_per_s = a, .twist_m_per_s = length}, in);
    const double lost = a - (sigma + 0.5 * curvature_m * y.speed * in.dt_s) * y.speed;
    task += y.speed * v;
    lost_squared += lost * lost;
    out.damping_m = std::max(out.damping_m, y.lambda);
  }
  out.lost_m_per_s = std::sqrt(lost_squared);
  return task;
}

// Joint speed of the wanted null motion along n, limited in size and in its change per tick.
template <int N>
double DifferentialInverse<N>::LimitedNullSpeed(const JointVectorN<N>& n,
                                                const MotionInput<N>& in) const OSTEON_RT {
  double change = std::numeric_limits<double>::infinity();
  for (int i = 0; i < N; ++i)
    change = std::min(change, params_.null_acceleration_share * acceleration_rad_per_s2_[i] * in.dt_s /
                                  std::max(std::abs(n[i]), kTiny));
  const double max_speed = params_.null_speed_rad_per_s, before = n.dot(in.qd_before);
  return std::clamp(std::clamp(n.dot(in.qd_null), -max_speed, max_speed), before - change, before + change);
}

// Joint speed along the unit direction v for the twist's component a, if the singular value sigma is below
// singular_zone_m.
template <int N>
typename DifferentialInverse<N>::DampedSpeed DifferentialInverse<N>::ComputeDampedSpeed(
    const SingularDirection& direction, const MotionInput<N>& in) const OSTEON_RT {
  const auto& [v, sigma_m, curvature_m, a_m_per_s, twist_m_per_s] = direction;
  const double share_before = in.share_before, dt_s = in.dt_s;
  // bounds of the motion along v, each set by the joint that reaches its own bound first
  double speed = std::numeric_limits<double>::infinity(), acceleration = speed, braking = speed;
  for (int i = 0; i < N; ++i) {
    const double component = std::max(std::abs(v[i]), kTiny);
    speed = std::min(speed, params_.singular_speed_share * speed_rad_per_s_[i] / component);
    acceleration = std::min(acceleration, acceleration_rad_per_s2_[i] / component);
    braking = std::min(braking,
                       0.5 * params_.limits[static_cast<std::size_t>(i)].acceleration_rad_per_s2 / component);
  }
  const double neutral_m = kDampedUpTo * params_.min_damping_m;
  const double curved_share = std::min(1.0, std::abs(curvature_m) / kReturning_m);
  const double zone_m = neutral_m + curved_share * (params_.singular_zone_m - neutral_m);
  if (sigma_m >= zone_m) return {.speed = a_m_per_s / sigma_m, .lambda = 0.0};
  const double edge = sigma_m / zone_m;
  const double depth = std::max(1.0 - edge * edge, kTiny);  // 0 at the zone's edge, for continuity

  // The damped speed y solves  damped_sigma y + depth curvature dt y^2 / 2 = a.  The second-order term is
  // used only if the motion makes sigma larger. In that case the damping also decreases with the curvature.
  const bool returns = a_m_per_s * curvature_m > 0.0;
  const double flat_damping_m = std::max(0.0, 1.0 - sigma_m / neutral_m) * params_.min_damping_m;
  const double min_damping2 = flat_damping_m * flat_damping_m * (returns ? 1.0 - curved_share : 1.0);
  double y = 0.0;
  if (sigma_m > 0.0 || (returns && min_damping2 == 0.0)) {
    const double damped_sigma_m = sigma_m + (min_damping2 > 0.0 ? min_damping2 / sigma_m : 0.0);
    const double second_order_m2 = returns ? 2.0 * depth * curvature_m * a_m_per_s * dt_s : 0.0;
    y = 2.0 * a_m_per_s / (damped_sigma_m + std::sqrt(damped_sigma_m * damped_sigma_m + second_order_m2));
  }

  // apply the bounds in this order: the joints' acceleration, their speed, the end of the reach
  if (share_before > 0.0) {  // the bound of the change applies to the unscaled speed, so undo the scaling of
                             // the previous tick
    const double before = v.dot(in.qd_before) / share_before;
    const double change = acceleration * dt_s / (depth * share_before);
    y = std::clamp(y, before - change, before + change);
  }
  y = std::clamp(y, -speed / depth, speed / depth);
  if (std::abs(curvature_m) > kTiny) {
    const double away = std::copysign(1.0, curvature_m);  // sign of y that makes sigma larger
    const double distance_rad = sigma_m / std::abs(curvature_m) - params_.singular_margin_rad;
    const double min_away = distance_rad > 0.0 ? -BrakingSpeed(distance_rad, braking, dt_s) / depth
                                               : std::min(-distance_rad / (kReturnTicks * dt_s),
                                                          twist_m_per_s / params_.turning_length_m);
    y = away * std::max(away * y, min_away);
  }
  const double ratio = y != 0.0 ? std::abs(a_m_per_s / y) : 0.0;
  const double damping_squared = sigma_m * (ratio - sigma_m);
  return {.speed = y, .lambda = damping_squared > 0.0 ? std::sqrt(damping_squared) : 0.0};
}

// Each joint's range of speeds in this tick: within its speed limit, and slow enough to brake before its
// position limit.
template <int N>
typename DifferentialInverse<N>::Box DifferentialInverse<N>::ComputeSpeedBox(const JointVectorN<N>& q,
                                                                             double dt_s) const OSTEON_RT {
  Box box;
  for (int i = 0; i < N; ++i) {
    const double to_upper_rad_per_s = std::max(0.0, high_rad_[i] - q[i]) / (braking_time_s_ + dt_s);
    const double to_lower_rad_per_s = std::max(0.0, q[i] - low_rad_[i]) / (braking_time_s_ + dt_s);
    const auto joint = static_cast<std::size_t>(i);
    box.high_brakes[joint] = to_upper_rad_per_s < speed_rad_per_s_[i];
    box.low_brakes[joint] = to_lower_rad_per_s < speed_rad_per_s_[i];
    box.high[i] = std::min(to_upper_rad_per_s, speed_rad_per_s_[i]);
    box.low[i] = -std::min(to_lower_rad_per_s, speed_rad_per_s_[i]);
  }
  return box;
}

// Limits the speed of the null motion by which the arm yields to the task. If the task asks too much of joint
// i, null motion relieves the joint through its component n_i. Near a posture where n_i is zero, full relief
// would need a very fast null motion, which changes its sign in that posture and would throw the arm back and
// forth. The limit is therefore proportional to |n_i| of each such joint. It is higher the less the joint is
// overloaded.
template <int N>
double DifferentialInverse<N>::MaxNullMotion(const Box& box, const JointVectorN<N>& task,
                                             const JointVectorN<N>& n, double r_wanted) const OSTEON_RT {
  double max_relief = kMaxRelief_rad_per_s;
  for (int i = 0; i < N; ++i) {
    const double asked = std::abs(task[i]), room = task[i] > 0.0 ? box.high[i] : -box.low[i];
    if (asked <= room) continue;
    max_relief = std::min(max_relief, kRelief_rad_per_s * std::abs(n[i]) * asked / (asked - room));
  }
  return std::max(max_relief, std::abs(r_wanted));
}

// Finds the largest s in [0, 1] for which some r keeps low <= s task + r n <= high. Each joint bounds r from
// below and from above by a line in s. L(s) is the highest of the lower lines and U(s) the lowest of the
// upper lines; L <= U at s = 0, and U - L is concave. If L > U at the present s, s is reduced to the point
// where these two lines meet. This step never passes the answer, and the same pair of lines does not come up
// again.
template <int N>
void DifferentialInverse<N>::ScaleIntoBox(const Box& box, const JointVectorN<N>& task,
                                          const JointVectorN<N>& n, double r_wanted,
                                          MotionOutput<N>& out) const OSTEON_RT {
  struct Line {  // a bound on r: at_0 + slope s
    double at_0, slope;
    int joint;  // the joint that sets this bound; -1: the limit of the relief (MaxNullMotion)
  };
  const auto store_limit_of = [&](int joint) {
    const auto at = static_cast<std::size_t>(joint);
    const bool brakes = task[joint] > 0.0 ? box.high_brakes[at] : box.low_brakes[at];
    out.joint = joint;
    out.limit = brakes ? MotionLimit::kPosition : MotionLimit::kVelocity;
  };
  double s = 1.0;
  for (int i = 0; i < N; ++i) {
    if (std::abs(n[i]) > kFlat || task[i] == 0.0) continue;
    const double max_share = (task[i] > 0.0 ? box.high[i] : box.low[i]) / task[i];
    if (max_share >= s) continue;
    s = max_share;
    store_limit_of(i);
  }
  const double relief = MaxNullMotion(box, task, n, r_wanted);
  double min_r = 0.0, max_r = 0.0;
  for (int step = 0; step <= 2 * N; ++step) {
    // the highest lower line and the lowest upper line at s
    Line lower{-relief, 0.0, -1}, upper{relief, 0.0, -1};
    for (int i = 0; i < N; ++i) {
      if (std::abs(n[i]) <= kFlat) continue;
      const double slope = -task[i] / n[i], a = box.low[i] / n[i], b = box.high[i] / n[i];
      const Line low{std::min(a, b), slope, i}, high{std::max(a, b), slope, i};
      if (low.at_0 + low.slope * s > lower.at_0 + lower.slope * s) lower = low;
      if (high.at_0 + high.slope * s < upper.at_0 + upper.slope * s) upper = high;
    }
    min_r = lower.at_0 + lower.slope * s;
    max_r = upper.at_0 + upper.slope * s;
    if (min_r <= max_r) break;
    const double meet = (upper.at_0 - lower.at_0) / (lower.slope - upper.slope);
    // two joints limit s together: name the one with less room
    const auto room = [&](int i) {
      return i < 0 ? std::numeric_limits<double>::infinity() : task[i] > 0.0 ? box.high[i] : -box.low[i];
    };
    store_limit_of(room(lower.joint) <= room(upper.joint) ? lower.joint : upper.joint);
    if (!(meet < s)) {  // rounding: the lines touch
      min_r = max_r = 0.5 * (min_r + max_r);
      break;
    }
    s = std::max(0.0, meet);
    min_r = max_r = lower.at_0 + lower.slope * s;
  }
  out.share = s;
  const double r = min_r < max_r ? std::clamp(r_wanted, min_r, max_r) : min_r;
  out.qd = s * task + r * n;
}

// Scales the change of the joint velocities so that every joint keeps its acceleration limit.
template <int N>
void DifferentialInverse<N>::LimitChange(const Box& box, const JointVectorN<N>& qd_before, double dt_s,
                                         MotionOutput<N>& out) const OSTEON_RT {
  const JointVectorN<N> change = out.qd - qd_before;
  double alpha = 1.0;
  int joint = -1;
  for (int i = 0; i < N; ++i) {
    const double max_change = acceleration_rad_per_s2_[i] * dt_s;
    if (alpha * std::abs(change[i]) <= max_change) continue;
    alpha = max_change / std::abs(change[i]);
    joint = i;
  }
  // position and speed limits take precedence: make at least the change that they require
  for (int i = 0; i < N; ++i) {
    const double bound = std::clamp(qd_before[i], box.low[i], box.high[i]);
    if (bound == qd_before[i] || change[i] == 0.0) continue;
    alpha = std::max(alpha, std::min(1.0, (bound - qd_before[i]) / change[i]));
  }
  if (alpha == 1.0) return;
  out.change_share = alpha;
  out.qd = qd_before + alpha * change;
  if (1.0 - alpha <= 1.0 - out.share) return;
  out.limit = MotionLimit::kAcceleration;
  out.joint = joint;
}

template class DifferentialInverse<6>;
template class DifferentialInverse<7>;

}  // namespace osteon::kinematics
