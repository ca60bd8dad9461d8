#include "studies/failures/loop/joint_limit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/QR>

#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using kinematics::JointVector;

// Allowed reversals of a joint's direction: a joint may reverse at its limit, when the hand turns back, and
// after the elbow has moved aside. A chattering joint reverses hundreds of times.
constexpr int kMaxReversals = 12;
// The hand's speed along the line, the time to reach this speed, and the pause at the turning point.
constexpr double kSpeed_m_per_s = 0.1, kRamp_s = 0.1, kRest_s = 0.3;

// One approach to a joint's limit, along a line.
struct Case {
  int joint{0};
  ArmTrialParams params{};
  Pose X_start{Pose::Identity()};
  Vector3 direction{Vector3::UnitX()};  // direction of the line along which the hand leads the tool
  double out_m{0.0};                    // distance from the start to the turning point
};

// @param room_rad  distance of the joint from its limit at the start
Case MakeCase(int joint, double room_rad, double out_m) {
  Case c{.joint = joint, .out_m = out_m};
  c.params = ScenarioTrial();
  const kinematics::JointLimits& limit = c.params.arm.limits[static_cast<std::size_t>(joint)];
  // take the limit on that side of zero on which the joint starts
  const double side = c.params.q_start[joint] < 0.0 ? -1.0 : 1.0;
  c.params.q_start[joint] = side > 0.0 ? limit.upper_rad - room_rad : limit.lower_rad + room_rad;
  const kinematics::LbrArm arm(c.params.arm);
  c.X_start = arm.FlangePose(c.params.q_start) * c.params.X_FT;
  c.direction =
      side * Vector3(arm.JacobianAt(c.params.q_start, c.params.X_FT.translation()).col(joint).head<3>())
                 .normalized();
  c.params.seconds = 2.0 * (out_m / kSpeed_m_per_s + kRamp_s) + kRest_s + 0.5;
  return c;
}

// The path of the hand along the line: out, pause, back, with a constant speed between short ramps.
HandPath PathOf(const Case& c) {
  return [X_start = c.X_start, direction = c.direction, out_m = c.out_m](double t) {
    const double leg_s = out_m / kSpeed_m_per_s + kRamp_s;
    const auto way = [&](double s) {  // position and speed on the way out or back
      s = std::clamp(s, 0.0, leg_s);
      if (s < kRamp_s) return std::pair{0.5 * kSpeed_m_per_s / kRamp_s * s * s, kSpeed_m_per_s * s / kRamp_s};
      if (s < leg_s - kRamp_s) return std::pair{kSpeed_m_per_s * (s - 0.5 * kRamp_s), kSpeed_m_per_s};
      const double left_s = leg_s - s;
      return std::pair{out_m - 0.5 * kSpeed_m_per_s / kRamp_s * left_s * left_s,
                       kSpeed_m_per_s * left_s / kRamp_s};
    };
    const auto [out, out_speed] = way(t);
    const auto [back, back_speed] = way(t - leg_s - kRest_s);
    HandGoal goal{.X_WT = X_start};
    goal.X_WT.translation() += (out - back) * direction;
    goal.V_WT.v = (out_speed - back_speed) * direction;
    return goal;
  };
}

// Judged results of one run.
struct TrialResult {
  double beside_m{0.0};      // largest distance of the tool from the line
  double backward_m{0.0};    // largest travel of the tool against the push, on the way out
  double beyond_rad{-1.0};   // largest distance of a joint beyond its limit
  double force_step_N{0.0};  // largest change of the hand's force in a millisecond
  double turned_rad{0.0};    // largest rotation of the tool from its start
  int reversals{0};  // sign changes of a joint's velocity (above 0.01 rad/s), for the joint that has the most
  bool fault{false};
};

TrialResult Measure(const Case& c, const std::vector<ArmTrialTick>& trial) {
  TrialResult m{.force_step_N = LargestForceStep(trial)};
  const double out_s = c.out_m / kSpeed_m_per_s + kRamp_s;
  double farthest = 0.0;
  std::array<double, 7> last_qd{};
  std::array<int, 7> reversals{};
  for (std::size_t i = 0; i < trial.size(); ++i) {
    const Vector3 way = trial[i].X_WT.translation() - c.X_start.translation();
    const double along = c.direction.dot(way);
    m.beside_m = std::max(m.beside_m, (way - along * c.direction).norm());
    m.turned_rad =
        std::max(m.turned_rad, LogRotation(c.X_start.linear().transpose() * trial[i].X_WT.linear()).norm());
    if (static_cast<double>(i) * 1e-3 < out_s) {
      m.backward_m = std::max(m.backward_m, farthest - along);
      farthest = std::max(farthest, along);
    }
    for (std::size_t j = 0; j < 7; ++j) {
      const double q = trial[i].q[static_cast<Eigen::Index>(j)];
      m.beyond_rad = std::max(
          {m.beyond_rad, q - c.params.arm.limits[j].upper_rad, c.params.arm.limits[j].lower_rad - q});
    }
    for (std::size_t j = 0; j < 7; ++j) {
      const double qd = trial[i].qd[static_cast<Eigen::Index>(j)];
      if (std::abs(qd) < 0.01) continue;
      if (qd * last_qd[j] < 0.0) ++reversals[j];
      last_qd[j] = qd;
    }
    m.fault |= trial[i].fault;
  }
  m.reversals = *std::ranges::max_element(reversals);
  return m;
}

}  // namespace

FailureResult RunJointLimit(const FailureSetting& setting) {
  FailureResult result{.id = 13,
                       .name = "joint limit",
                       .metric = "farthest that the tool leaves the line it is led along",
                       .unit = "mm",
                       .baseline_name = "pseudo-inverse, each joint clamped at its limits alone",
                       .bound = 1.0};
  const control::ServoParams defaults;  // the parameters that the servo loop has by default
  const double margin_rad = defaults.joints.position_margin_rad;
  const std::vector<int> joints = setting.full() ? std::vector<int>{0, 1, 3, 5} : std::vector<int>{1, 5};
  std::vector<Case> cases;
  for (const int joint : joints)
    for (const double out_m : setting.full() ? std::vector<double>{0.2, 0.4} : std::vector<double>{0.3})
      cases.push_back(MakeCase(joint, 0.3, out_m));

  bool complete = true, faulted = false;
  int baselines_fail = 0, reversals = 0;
  double backward_m = 0.0, beyond_rad = -1.0, force_step_N = 0.0, turned_rad = 0.0;
  for (std::size_t i = 0; i < cases.size() && complete; ++i) {
    const Case& c = cases[i];
    const StepMethod clamp = [&c, margin_rad](const kinematics::Jacobian& J, const JointVector& q,
                                              const Twist& V_BT, double dt_s) {
      Eigen::Matrix<double, 6, 1> V;
      V << V_BT.v, V_BT.w;
      JointVector step = dt_s * J.completeOrthogonalDecomposition().solve(V);
      for (int j = 0; j < 7; ++j) {
        const kinematics::JointLimits& limit = c.params.arm.limits[static_cast<std::size_t>(j)];
        const double max_step_rad = limit.velocity_rad_per_s * dt_s;
        step[j] = std::clamp(q[j] + std::clamp(step[j], -max_step_rad, max_step_rad),
                             limit.lower_rad + margin_rad, limit.upper_rad - margin_rad) -
                  q[j];
      }
      return step;
    };
    const std::vector<ArmTrialTick> ours = RunLoopTrial(c.params, PathOf(c));
    const std::vector<ArmTrialTick> clamped = RunMethodTrial(c.params, PathOf(c), clamp);
    const TrialResult m = Measure(c, ours), b = Measure(c, clamped);
    if (1e3 * b.beside_m > result.bound) ++baselines_fail;
    result.ours = std::max(result.ours, 1e3 * m.beside_m);
    if (1e3 * b.beside_m >= result.baseline) {
      result.baseline = 1e3 * b.beside_m;
      FailureSeries of_ours{.name = "ours", .ours = true}, of_clamp{.name = "joints clamped alone"};
      const auto add = [&c](const std::vector<ArmTrialTick>& trial, FailureSeries& series) {
        for (std::size_t k = 0; k < trial.size(); k += 4) {
          const Vector3 way = trial[k].X_WT.translation() - c.X_start.translation();
          const double along = c.direction.dot(way);
          series.x.push_back(1e3 * along);
          series.y.push_back(1e3 * (way - along * c.direction).norm());
        }
      };
      add(ours, of_ours);
      add(clamped, of_clamp);
      result.plot = {.x_label = fmt::format("way along the line, against the limit of A{} [mm]", c.joint + 1),
                     .y_label = "way beside the line [mm]",
                     .series = {of_clamp, of_ours},
                     .bound_is_on_y = true};
    }
    backward_m = std::max(backward_m, m.backward_m);
    beyond_rad = std::max(beyond_rad, m.beyond_rad);
    force_step_N = std::max(force_step_N, m.force_step_N);
    turned_rad = std::max(turned_rad, m.turned_rad);
    reversals = std::max(reversals, m.reversals);
    faulted |= m.fault;
    complete = setting.GoesOn(static_cast<double>(i + 1) / static_cast<double>(cases.size()));
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && !faulted && result.ours <= result.bound && backward_m < 1e-6 &&
                       beyond_rad <= -margin_rad + 1e-9 && force_step_N < 5.0 && reversals <= kMaxReversals;
  result.note = fmt::format(
      "{} approaches, the baseline fails in {}; with ours the tool comes back by {:.2g} um while the hand "
      "pushes on and turns by {:.1f} mrad, no joint turns back more than {} times, joints stay {:.2f} deg "
      "inside their limits, the hand's force changes by {:.2f} N in a millisecond at most",
      cases.size(), baselines_fail, 1e6 * backward_m, 1e3 * turned_rad, reversals,
      -beyond_rad * 180.0 / std::numbers::pi, force_step_N);
  return result;
}

}  // namespace osteon::studies
