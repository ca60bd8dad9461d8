#include "studies/stability/guided_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/laws/admittance_law.h"

namespace osteon::studies {
namespace {

// The loop lies in a plane: x is lateral, the feed is along z, so the cup's axis is -z. The tool tilts about
// y.
const Vector3 kAxis_W{0.0, 0.0, -1.0};

// Pose of a tool that is displaced along x and tilted about y.
Pose PlanarPose(double aside_m, double tilt_rad) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({0.0, tilt_rad, 0.0});
  X.translation() = Vector3(aside_m, 0.0, 0.0);
  return X;
}

// Computes GuidedLoop::stiffness() by central differences, at a pose in the linear part of funnel and cone:
// beyond their soft start (ease) and below their cap.
Eigen::Matrix2d StiffnessOf(control::GuidanceParams guidance) {
  guidance.axis_W = kAxis_W;
  guidance.centre_W = {0.0, 0.0, -guidance.head_m};
  guidance.lateral.cap = guidance.cone.cap = guidance.depth.cap = std::numeric_limits<double>::max();
  const double tilt = guidance.cone_free_rad + 2.0 * guidance.cone.ease;
  // The head stays at height 0, where the depth's spring exerts no force.
  const double aside_m =
      guidance.lateral_free_m + 2.0 * guidance.lateral.ease + guidance.head_m * std::sin(tilt);
  guidance.depth_soft_m = -1.0;
  // Returns (lateral force, torque) at a displacement from this pose.
  const auto wrench = [&](double x, double turn) {
    Pose X = PlanarPose(aside_m + x, tilt + turn);
    X.translation().z() = guidance.head_m * (std::cos(tilt) - 1.0);
    const Wrench F = control::EvaluateGuidance(guidance, X, {}).F_T_W;
    return Eigen::Vector2d(F.f.x(), F.t.y());
  };
  constexpr double kStep_m = 1e-7, kStep_rad = 1e-7;
  Eigen::Matrix2d stiffness;
  stiffness.col(0) = -(wrench(kStep_m, 0.0) - wrench(-kStep_m, 0.0)) / (2.0 * kStep_m);
  stiffness.col(1) = -(wrench(0.0, kStep_rad) - wrench(0.0, -kStep_rad)) / (2.0 * kStep_rad);
  return stiffness;
}

}  // namespace

// State, for the lateral motion: commanded positions now and earlier; the arm's x, x', and x' a period ago;
// the virtual tool's velocity. The same for the tilt. Then the hand's forces of earlier ticks.
GuidedLoop::GuidedLoop(const GuidedLoopParams& params)
    : params_(params),
      linear_arm_(hil::LinearArm(params.arm, params.period_s)),
      stiffness_(StiffnessOf(params.guidance)),
      history_(std::max(1, linear_arm_.history())),
      size_(2 * (history_ + 4) + params.sensor_delay) {}

Eigen::VectorXd GuidedLoop::Step(const Eigen::VectorXd& s) const {
  const hil::GridHand& hand = params_.hand;
  const double lever_m = params_.lever_m;
  const int coordinate = history_ + 4;
  // each has the elements (lateral, tilt): the arm's position, velocity and acceleration; the command; the
  // velocity of the virtual tool
  Eigen::Vector2d x, v, a, commanded, speed;
  for (int i = 0; i < 2; ++i) {
    const int at = i * coordinate;
    x[i] = s[at + history_];
    v[i] = s[at + history_ + 1];
    a[i] = (v[i] - s[at + history_ + 2]) / params_.period_s;
    commanded[i] = s[at];
    speed[i] = s[at + history_ + 3];
  }
  // Converts a motion (lateral, tilt) of the apex to the lateral motion at the hand, lever_m behind the apex.
  const auto at_hand = [&](const Eigen::Vector2d& of) { return of[0] - lever_m * of[1]; };
  const double felt_N =
      -(hand.stiffness_N_per_m * at_hand(x) + hand.damping_Ns_per_m * at_hand(v) + hand.mass_kg * at_hand(a));
  const int felt_at = 2 * coordinate;
  const double told_N = params_.sensor_delay == 0 ? felt_N : s[felt_at + params_.sensor_delay - 1];

  const Eigen::Vector2d guidance = -stiffness_ * (params_.on == GuidanceOn::kCommanded ? commanded : x);
  control::AdmittanceParams law;
  law.mass_kg.setConstant(params_.mass_kg);
  law.damping_Ns_per_m.setConstant(params_.damping_Ns_per_m);
  law.inertia_kg_m2.setConstant(params_.inertia_kg_m2);
  law.damping_Nms_per_rad.setConstant(params_.damping_Nms_per_rad);
  law.centre_T_m.z() = -params_.centre_m;
  control::AdmittanceState tool;  // linearised about an upright tool
  tool.V_WT = {.v = {speed[0], 0.0, 0.0}, .w = {0.0, speed[1], 0.0}};
  const Wrench F_T_W{.f = {told_N + guidance[0], 0.0, 0.0}, .t = {0.0, -lever_m * told_N + guidance[1], 0.0}};
  if (!control::StepAdmittance(law, F_T_W, params_.period_s, tool))
    return Eigen::VectorXd::Constant(size_, std::numeric_limits<double>::infinity());

  Eigen::VectorXd next(size_);
  const Eigen::Vector2d speed_next(tool.V_WT.v.x(), tool.V_WT.w.y());
  const Eigen::Vector2d commanded_next = commanded + params_.period_s * speed_next;
  for (int i = 0; i < 2; ++i) {
    const int at = i * coordinate;
    next[at] = commanded_next[i];
    for (int j = 1; j < history_; ++j) next[at + j] = s[at + j - 1];
    // Returns the command that was sent `ago` ticks ago. If the dead time is not a whole number of periods,
    // two commands act in a period (see LoopArm::step).
    const auto sent = [&](int ago) { return ago == 0 ? commanded_next[i] : s[at + ago - 1]; };
    const double earlier = linear_arm_.split ? sent(linear_arm_.whole + 1) : 0.0;
    next.segment<2>(at + history_) =
        linear_arm_.step * Eigen::Vector4d(x[i], v[i], earlier, sent(linear_arm_.whole));
    next[at + history_ + 2] = v[i];
    next[at + history_ + 3] = speed_next[i];
  }
  for (int j = 0; j < params_.sensor_delay; ++j) next[felt_at + j] = j == 0 ? felt_N : s[felt_at + j - 1];
  return next;
}

double GuidedLoop::SpectralRadius() const {
  return hil::SpectralRadius(hil::LoopMatrix([this](const Eigen::VectorXd& s) { return Step(s); }, size_));
}

std::vector<double> GuidanceLevers_m() { return {0.025, 0.1, 0.25}; }

std::vector<HeldHand> GuidanceHands() {
  std::vector<HeldHand> hands;
  for (const hil::GridHand& hand : hil::HandGrid()) {
    if (hand.name == "fixture" || hand.name == "clamp") continue;
    for (const double lever_m : GuidanceLevers_m()) hands.push_back({.hand = hand, .lever_m = lever_m});
  }
  return hands;
}

std::vector<HeldHand> HandsStableWithoutGuidance(GuidedLoopParams params) {
  params.guidance.lateral.stiffness = params.guidance.cone.stiffness = params.guidance.depth.stiffness = 0.0;
  std::vector<HeldHand> hands = GuidanceHands();
  std::erase_if(hands, [&](const HeldHand& held) {
    params.hand = held.hand;
    params.lever_m = held.lever_m;
    return !GuidedLoop(params).IsStable();
  });
  return hands;
}

std::vector<std::size_t> HandsThatGuidanceMakesUnstable(GuidedLoopParams params,
                                                        const std::vector<HeldHand>& hands, int n) {
  const double lateral = params.guidance.lateral.stiffness, cone = params.guidance.cone.stiffness;
  std::vector<std::size_t> unstable;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    params.hand = hands[i].hand;
    params.lever_m = hands[i].lever_m;
    bool stable = true;
    for (int at = 0; at < n * n && stable; ++at) {  // index of a cell of the grid
      params.guidance.lateral.stiffness = lateral * (at / n) / (n - 1);
      params.guidance.cone.stiffness = cone * (at % n) / (n - 1);
      stable = GuidedLoop(params).IsStable();
    }
    if (!stable) unstable.push_back(i);
  }
  return unstable;
}

hil::Boundary GuidanceBoundary(GuidedLoopParams params, const std::vector<HeldHand>& hands,
                               double max_factor) {
  const double lateral = params.guidance.lateral.stiffness, cone = params.guidance.cone.stiffness;
  return hil::FirstCrossing(
      [&](double factor) {
        params.guidance.lateral.stiffness = factor * lateral;
        params.guidance.cone.stiffness = factor * cone;
        return HandsThatGuidanceMakesUnstable(params, hands).empty();
      },
      {.from = 0.1, .to = max_factor, .factor = 1.1, .tolerance = 1e-2});
}

}  // namespace osteon::studies
