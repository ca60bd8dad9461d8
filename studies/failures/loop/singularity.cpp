#include "studies/failures/loop/singularity.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "studies/failures/arm_bench.h"

namespace osteon::studies {
namespace {

using kinematics::JointVector;

// An arm, and the path on which a hand leads its tool into or past a singular posture.
struct Case {
  std::string name;
  ArmTrialParams params{};
  HandPath path{};
  bool wrist{false};
};

// A smooth step from 0 to 1 and its slope at a time; twice continuously differentiable.
struct Blend {
  double s, slope_per_s;
};
Blend Smooth(double t_s, double duration_s) {
  const double u = std::clamp(t_s / duration_s, 0.0, 1.0);
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration_s};
}

// A path by `out_m` along a direction and back with the given peak speed. A sideways motion by `side_m` takes
// the whole time.
HandPath OutAndBack(const Pose& X_start, const Vector3& direction, double out_m, double speed_m_per_s,
                    const Vector3& side_m) {
  const double leg_s = 1.875 * std::abs(out_m) / speed_m_per_s, rest_s = 0.5;
  return [=](double t) {
    const Blend out = Smooth(t, leg_s), back = Smooth(t - leg_s - rest_s, leg_s);
    const Blend side = Smooth(t - leg_s, rest_s + leg_s);
    HandGoal goal{.X_WT = X_start};
    goal.X_WT.translation() += out_m * (out.s - back.s) * direction + side.s * side_m;
    goal.V_WT.v = out_m * (out.slope_per_s - back.slope_per_s) * direction + side.slope_per_s * side_m;
    return goal;
  };
}

// The tool moves out along the line from shoulder to wrist, and back.
// @param beyond_m  distance of the turning point beyond the arm's reach; negative: before it
// @param side_m    sideways motion from the turning point to the end
Case ElbowCase(const std::string& name, double beyond_m, const Vector3& side_m) {
  Case c{.name = name};
  c.params.arm = ScenarioArm();
  c.params.X_FT = ScenarioTool();
  c.params.q_start << 0.1, 0.7, 0.0, -0.6, 0.1, 0.7, 0.2;
  const kinematics::LbrArm arm(c.params.arm);
  const Pose X_WF = arm.FlangePose(c.params.q_start);
  const Vector3 p_SW =
      X_WF * Vector3(0, 0, -c.params.arm.wrist_to_flange_m) - Vector3(0, 0, c.params.arm.base_to_shoulder_m);
  // distance that remains to the arm's reach
  const double left_m = c.params.arm.shoulder_to_elbow_m + c.params.arm.elbow_to_wrist_m - p_SW.norm();
  const double out_m = left_m + beyond_m;
  c.path = OutAndBack(X_WF * c.params.X_FT, p_SW.normalized(), out_m, 0.1, side_m);
  c.params.seconds = 2.0 * 1.875 * out_m / 0.1 + 0.5 + 1.0;
  return c;
}

// The tool is pulled down and back out of the posture in which all joints are zero.
Case CandleCase() {
  Case c{.name = "candle, pulled down and back"};
  c.params.arm = ScenarioArm();
  c.params.X_FT = ScenarioTool();
  const Pose X_WT = kinematics::LbrArm(c.params.arm).FlangePose(c.params.q_start) * c.params.X_FT;
  c.path = OutAndBack(X_WT, Vector3(0, 0, -1), 0.06, 0.1, Vector3::Zero());
  c.params.seconds = 2.0 * 1.875 * 0.6 + 0.5 + 1.0;
  return c;
}

// A6 goes from 0.5 to -0.5 rad with A5 at 90 deg, while all other joints keep their positions. The path is
// then rotated by miss_rad about the axis of rotation that the arm loses when the wrist is straight.
Case WristCase(double miss_rad) {
  constexpr double kSwing_rad = 0.5, kRate_rad_per_s = 1.0;
  Case c{.name = fmt::format("wrist, missed by {:g} rad", miss_rad), .wrist = true};
  c.params.arm = ScenarioArm();
  c.params.X_FT = ScenarioTool();
  c.params.q_start << 0.1, 0.6, 0.0, -1.4, std::numbers::pi / 2, kSwing_rad, 0.2;
  const kinematics::LbrArm arm(c.params.arm);
  JointVector straight = c.params.q_start;
  straight[5] = 0.0;
  const Pose X_FT = c.params.X_FT;
  const kinematics::Jacobian J = arm.JacobianAt(straight, X_FT.translation());
  const Eigen::Matrix<double, 6, 1> lost = J.jacobiSvd(Eigen::ComputeFullU).matrixU().col(5);
  const Vector3 axis = lost.tail<3>().normalized();
  const double duration_s = 1.875 * 2.0 * kSwing_rad / kRate_rad_per_s;
  const JointVector start = c.params.q_start;
  // the rotation by miss_rad grows over the first third of the path, so that the path starts at the arm's
  // pose
  c.path = [=](double t) {
    const Blend turn = Smooth(t, duration_s), off = Smooth(t, duration_s / 3.0);
    JointVector q = start;
    q[5] -= 2.0 * kSwing_rad * turn.s;
    HandGoal goal{.X_WT = arm.FlangePose(q) * X_FT};
    const Eigen::Matrix<double, 6, 1> V =
        arm.JacobianAt(q, X_FT.translation()).col(5) * (-2.0 * kSwing_rad * turn.slope_per_s);
    const Matrix3 R_off = ExpRotation(miss_rad * off.s * axis);
    goal.X_WT.linear() = R_off * goal.X_WT.linear();
    goal.V_WT = {.v = V.head<3>(), .w = R_off * V.tail<3>() + miss_rad * off.slope_per_s * axis};
    return goal;
  };
  c.params.seconds = duration_s + 1.0;
  return c;
}

// Judged results of one run.
struct TrialResult {
  double speed_share{0.0};            // largest joint speed over that joint's limit
  double force_step_N{0.0};           // largest change of the hand's force in a millisecond
  double left_m{0.0}, left_rad{0.0};  // distance of the tool from the hand's goal at the end
  bool fault{false};
};

TrialResult Measure(const Case& c, const std::vector<ArmTrialTick>& trial) {
  TrialResult m{.force_step_N = LargestForceStep(trial)};
  for (const ArmTrialTick& tick : trial) {
    m.speed_share = std::max(m.speed_share, JointSpeedShare(c.params.arm, tick.qd));
    m.fault |= tick.fault;
  }
  // the tool must end where the hand ends
  const ArmTrialTick& last = trial.back();
  m.left_m = (last.X_WT.translation() - last.goal.X_WT.translation()).norm();
  m.left_rad = LogRotation(last.X_WT.linear().transpose() * last.goal.X_WT.linear()).norm();
  return m;
}

// The baseline's joint step: the pseudo-inverse of the Jacobian, without any limit.
JointVector PlainInverse(const kinematics::Jacobian& J, const JointVector&, const Twist& V_BT, double dt_s) {
  Eigen::Matrix<double, 6, 1> V;
  V << V_BT.v, V_BT.w;
  return dt_s * J.completeOrthogonalDecomposition().solve(V);
}

}  // namespace

FailureResult RunSingularity(const FailureSetting& setting) {
  FailureResult result{.id = 12,
                       .name = "singularity",
                       .metric = "largest joint speed, share of the joint's limit",
                       .unit = "1",
                       .baseline_name = "pseudo-inverse of the Jacobian",
                       .bound = 1.0};
  std::vector<Case> cases{ElbowCase("elbow, pushed 60 mm beyond its reach", 0.06, Vector3::Zero()),
                          ElbowCase("elbow, 0.1 mm short of its reach", -1e-4, Vector3::Zero()), CandleCase(),
                          WristCase(0.0), WristCase(1e-3)};
  if (setting.full()) {
    cases.push_back(ElbowCase("elbow, 5 mm short of its reach", -5e-3, Vector3::Zero()));
    cases.push_back(ElbowCase("elbow, slid 150 mm along its reach", 0.02, Vector3(0.0, 0.15, 0.0)));
    for (const double miss : {1e-6, 1e-4, 5e-3, 1e-2, 2e-2, 5e-2}) cases.push_back(WristCase(miss));
  }

  bool complete = true, faulted = false;
  int baselines_fail = 0;
  double force_step_N = 0.0, baseline_force_step_N = 0.0, left_m = 0.0, left_rad = 0.0;
  std::string worst;
  for (std::size_t i = 0; i < cases.size() && complete; ++i) {
    const Case& c = cases[i];
    const std::vector<ArmTrialTick> ours = RunLoopTrial(c.params, c.path);
    const std::vector<ArmTrialTick> plain = RunMethodTrial(c.params, c.path, PlainInverse);
    const TrialResult m = Measure(c, ours), b = Measure(c, plain);
    if (b.speed_share > result.bound) ++baselines_fail;
    if (m.speed_share >= result.ours) worst = c.name;
    result.ours = std::max(result.ours, m.speed_share);
    result.baseline = std::max(result.baseline, b.speed_share);
    force_step_N = std::max(force_step_N, m.force_step_N);
    baseline_force_step_N = std::max(baseline_force_step_N, b.force_step_N);
    left_m = std::max(left_m, m.left_m);
    left_rad = std::max(left_rad, m.left_rad);
    faulted |= m.fault;
    if (i == 0) {
      FailureSeries of_ours{.name = "ours", .ours = true}, of_plain{.name = "pseudo-inverse"};
      const auto add = [&c](const std::vector<ArmTrialTick>& trial, FailureSeries& series) {
        for (std::size_t k = 0; k < trial.size(); k += 4) {
          series.x.push_back(static_cast<double>(k) * 1e-3);
          series.y.push_back(std::max(1e-3, JointSpeedShare(c.params.arm, trial[k].qd)));
        }
      };
      add(ours, of_ours);
      add(plain, of_plain);
      result.plot = {.x_label = "time [s], elbow pushed straight and back",
                     .y_label = "largest joint speed, share of its limit",
                     .log_y = true,
                     .series = {of_plain, of_ours},
                     .bound_is_on_y = true};
    }
    complete = setting.GoesOn(static_cast<double>(i + 1) / static_cast<double>(cases.size()));
  }
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && !faulted && result.ours <= result.bound && force_step_N < 5.0 &&
                       left_m < 3e-3 && left_rad < 0.03;
  result.note = fmt::format(
      "{} cases, the baseline fails in {}; ours is fastest in \"{}\"; the hand's force changes by {:.2f} N "
      "in a millisecond at most ({:.0f} N with the baseline), and at the end the tool is within {:.1f} mm "
      "and {:.0f} mrad of where the hand led it",
      cases.size(), baselines_fail, worst, force_step_N, baseline_force_step_N, 1e3 * left_m, 1e3 * left_rad);
  return result;
}

}  // namespace osteon::studies
