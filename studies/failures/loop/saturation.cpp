#include "studies/failures/loop/saturation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <Eigen/QR>

#include "hil/operator/quintic.h"
#include "kinematics/serial_chain.h"
#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using kinematics::JointVector;

constexpr double kDt_s = 1e-3, kWall_N_per_m = 20e3, kPush_N = 200.0, kCeiling_N = 200.0;
// The hand presses within kPress_s, holds until kDrawBack_s, and draws back within kPress_s.
constexpr double kPress_s = 0.5, kDrawBack_s = 0.7, kEnd_s = 1.6;
// Depth limit: its bound below the wall's face, and the range before the bound in which it resists.
constexpr double kDeepest_m = 12e-3, kSoft_m = 7e-3;
// Share of the requested force from which on the force counts as whole.
constexpr double kWhole = 0.99;
constexpr double kMaxRecovery_s = 0.05;  // bound on the time until the whole force is back
// Direction is judged only if the requested force is larger.
constexpr double kCounts_N = 1.0;
constexpr double kSlack = 1.0 + 1e-9;  // tolerance of a torque limit, for rounding

// Judged results of one push; the baseline is computed for the same poses.
struct PushResult {
  // largest angle to the requested force: of the rendered force, and of the force of clipped torques
  // (baseline)
  double angle_rad{0.0}, clipped_angle_rad{0.0};
  double torque_share{0.0};  // largest (|J^T F| + |g|) / limit
  double min_share{1.0};     // least ratio of the rendered to the requested force
  double max_N{0.0}, max_wanted_N{0.0};
  // longest time from when the arm can hold the whole force until the whole force is rendered
  double recovery_s{0.0};
  bool saturates{false};  // in some tick the arm could not hold the whole requested force
  bool recovers{false};   // the whole requested force is rendered at the end
  bool fault{false};
  std::vector<double> angle_deg, clipped_deg;  // the two angles, for each tick
};

double Angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Simulates one push against a plane across the tool.
// @param tool_m         length of the tool
// @param side_rad       direction out of the plane, as an angle about the tool's axis from its x
// @param depth_limited  a depth limit's resistance adds to the wall's force from some depth on
PushResult Press(double tool_m, double side_rad, bool depth_limited) {
  ArmTrialParams params = ScenarioTrial();
  params.X_FT.translation() = Vector3(0.0, 0.0, tool_m);
  params.hand.max_force_N = kPush_N;
  params.seconds = kEnd_s;
  params.loop.arm_body = ScenarioBody();
  params.loop.twist.max_speed_m_per_s = 0.25;
  const kinematics::LbrArm arm(params.arm);
  const kinematics::SerialChain<7> body(ScenarioBody());
  const Pose X_start = arm.FlangePose(params.q_start) * params.X_FT;
  // direction out of the plane, across the tool
  const Vector3 n = X_start.linear() * Vector3(std::cos(side_rad), std::sin(side_rad), 0.0);

  if (depth_limited)
    params.loop.depth = {.acts = true,
                         .bound = {.shape = safety::ZoneShape::kHalfSpace,
                                   .p_W_m = X_start.translation() - kDeepest_m * n,
                                   .R_W = RotationFromZTo(n)},
                         .soft_m = kSoft_m,
                         .spindle_stop_m = 0.0,
                         .stiffness_N_per_m = kWall_N_per_m,
                         .damping_Ns_per_m = 0.0};
  const double pressed_m = kPush_N / params.hand.stiffness_N_per_m + kPush_N / kWall_N_per_m;
  const HandPath path = [&](double t) {
    const auto led = [](double share) { return hil::Quintic(std::clamp(share, 0.0, 1.0)).s; };
    HandGoal goal{.X_WT = X_start};
    goal.X_WT.translation() -= pressed_m * (led(t / kPress_s) - led((t - kDrawBack_s) / kPress_s)) * n;
    return goal;
  };
  hil::HandImpedance hand(params.hand);
  const ArmScene scene{.hand =
                           [&](int tick, const Pose& X_WT, const Twist& V_WT) {
                             const HandGoal goal = path(tick * kDt_s);
                             return safety::ScaleWrench(hand.Step(kDt_s, X_WT, V_WT, goal.X_WT, goal.V_WT),
                                                        kPush_N, params.hand.max_torque_Nm)
                                 .F;
                           },
                       .bone =
                           [&](int tick, rt::Nanoseconds now, const Pose&) {
                             const simulation::Contact plane =
                                 PlaneAt(X_start.translation(), n, kWall_N_per_m);
                             return FreshModel(static_cast<std::uint64_t>(tick + 1), now, {&plane, 1});
                           }};
  // Test the limiter alone: a force that returns adds energy, so the passivity controller would damp it.
  params.loop.stabilisers.passivity.acts = false;
  // without damping the requested force follows from the pose alone
  params.loop.coupling.damping_Ns_per_m = 0.0;
  const std::vector<ArmTrialTick> trial = RunLoopTrial(params, scene);

  PushResult result;
  double could_since_s = 0.0;  // time since which the arm can hold the whole force
  bool is_whole = true;
  for (std::size_t i = 1; i < trial.size(); ++i) {
    const ArmTrialTick& tick = trial[i];
    result.fault |= tick.fault;
    // the requested force: that of the planes at the pose that the previous tick commanded
    const double depth_m = -n.dot(trial[i - 1].X_WT.translation() - X_start.translation());
    double wanted_N = kWall_N_per_m * std::max(0.0, depth_m);
    if (depth_limited) wanted_N += kWall_N_per_m * std::max(0.0, depth_m - (kDeepest_m - kSoft_m));
    const Vector3 f_wanted = wanted_N * n, f = tick.f_coupling_N;
    const JointVector g = body.Gravity(trial[i - 1].q);
    const kinematics::Jacobian J = arm.JacobianAt(trial[i - 1].q, params.X_FT.translation());
    const JointVector tau_wanted = J.topRows<3>().transpose() * f_wanted;
    const JointVector tau = J.topRows<3>().transpose() * f;
    JointVector clipped = tau_wanted;
    // whether the arm can hold the whole requested force, if gravity only reduces what it can hold
    bool can_hold = wanted_N <= kCeiling_N;
    for (std::size_t j = 0; j < 7; ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      const double limit = params.arm.limits[j].torque_Nm, room = limit - std::abs(g[k]);
      result.torque_share = std::max(result.torque_share, (std::abs(tau[k]) + std::abs(g[k])) / limit);
      clipped[k] = std::clamp(tau_wanted[k], -room, room);
      can_hold &= std::abs(tau_wanted[k]) <= room;
    }
    result.max_N = std::max(result.max_N, f.norm());
    result.max_wanted_N = std::max(result.max_wanted_N, wanted_N);
    if (wanted_N > kCounts_N) {
      const Vector3 f_clipped =
          Eigen::Matrix<double, 7, 6>(J.transpose()).colPivHouseholderQr().solve(clipped).head<3>();
      result.angle_rad = std::max(result.angle_rad, Angle(f, f_wanted));
      result.clipped_angle_rad = std::max(result.clipped_angle_rad, Angle(f_clipped, f_wanted));
      result.angle_deg.push_back(180.0 / std::numbers::pi * Angle(f, f_wanted));
      result.clipped_deg.push_back(180.0 / std::numbers::pi * Angle(f_clipped, f_wanted));
      result.min_share = std::min(result.min_share, f.norm() / wanted_N);
    } else {
      result.angle_deg.push_back(0.0);
      result.clipped_deg.push_back(0.0);
    }
    // Measure the time until the whole force is rendered again.
    result.saturates |= !can_hold;
    if (!can_hold) could_since_s = static_cast<double>(i + 1) * kDt_s;
    if (can_hold && result.saturates && f.norm() < kWhole * wanted_N)
      result.recovery_s = std::max(result.recovery_s, static_cast<double>(i + 1) * kDt_s - could_since_s);
    is_whole = can_hold && f.norm() >= kWhole * wanted_N;
  }
  result.recovers = is_whole;
  return result;
}

}  // namespace

FailureResult RunSaturation(const FailureSetting& setting) {
  FailureResult result{.id = 17,
                       .name = "saturation",
                       .metric = "angle of the rendered force to the one that was to be",
                       .unit = "deg",
                       .baseline_name = "each joint's torque clipped at its limit",
                       .bound = 1.0};
  const int sides = setting.full() ? 12 : 3;
  const std::vector<double> tools_m = setting.full() ? std::vector{0.2, 0.3} : std::vector{0.3};
  PushResult worst;
  double torque_share = 0.0, recovery_s = 0.0, min_share = 1.0, max_N = 0.0;
  int done = 0, saturated = 0;
  bool complete = true, all_recover = true;  // without faults
  for (const double tool_m : tools_m) {
    for (int side = 0; side < sides && complete; ++side) {
      const PushResult s = Press(tool_m, 2.0 * std::numbers::pi * (side + 0.3) / sides, side % 2 == 1);
      saturated += s.saturates ? 1 : 0;
      all_recover &= s.recovers && !s.fault;
      result.ours = std::max(result.ours, 180.0 / std::numbers::pi * s.angle_rad);
      torque_share = std::max(torque_share, s.torque_share);
      recovery_s = std::max(recovery_s, s.recovery_s);
      min_share = std::min(min_share, s.min_share);
      max_N = std::max(max_N, s.max_N);
      if (s.clipped_angle_rad >= worst.clipped_angle_rad) worst = s;
      complete =
          setting.GoesOn(++done / static_cast<double>(tools_m.size() * static_cast<std::size_t>(sides)));
    }
  }
  result.baseline = 180.0 / std::numbers::pi * worst.clipped_angle_rad;
  FailureSeries ours{.name = "ours", .y = worst.angle_deg, .ours = true};
  FailureSeries clipped{.name = "torques clipped alone", .y = worst.clipped_deg};
  for (std::size_t i = 0; i < ours.y.size(); ++i) ours.x.push_back(static_cast<double>(i) * kDt_s);
  clipped.x = ours.x;
  result.plot = {.x_label = "time [s]; pressed until 0.7 s, drawn back until 1.2 s",
                 .y_label = "angle to the force that was to be [deg]",
                 .series = {clipped, ours},
                 .bound_is_on_y = true};
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && all_recover && saturated > 0 && result.ours <= result.bound &&
                       torque_share <= kSlack && max_N <= kCeiling_N && recovery_s <= kMaxRecovery_s;
  result.note = fmt::format(
      "every second push meets the depth limit as well; {} of {} are more than the arm holds, {:.0f} N are "
      "rendered at most, {:.0f} % of what was to be at least; joints carry {:.2f} % of their limit at most "
      "(gravity counted against them), and the whole force is back {:.0f} ms after the arm can hold it",
      saturated, done, max_N, 100.0 * min_share, 100.0 * torque_share, 1e3 * recovery_s);
  return result;
}

}  // namespace osteon::studies
