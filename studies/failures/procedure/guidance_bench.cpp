#include "studies/failures/procedure/guidance_bench.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "control/laws/twist_parts.h"

namespace osteon::studies {
namespace {

constexpr double kStartHeight_m = 5e-3;  // height of the head's centre above its planned place at the start

// Joint limits that do not limit the speed.
std::array<kinematics::JointLimits, 7> Unlimited() {
  std::array<kinematics::JointLimits, 7> limits;
  for (kinematics::JointLimits& each : limits) each.velocity_rad_per_s = std::numeric_limits<double>::max();
  return limits;
}

// Converts a pose to the seven "joints" of the bench's arm: position [m], rotation vector since the start
// [rad], and an unused seventh value.
kinematics::JointVector ValuesOf(const Pose& X, const Matrix3& R_start) {
  kinematics::JointVector values = kinematics::JointVector::Zero();
  values.head<3>() = X.translation();
  values.segment<3>(3) = LogRotation(X.linear() * R_start.transpose());
  return values;
}

// An arm at rest, whose tool is at the given pose.
hil::ServoArm ArmAt(const Pose& X, const Matrix3& R_start) {
  return hil::ServoArm(hil::ServoArmParams{}, Unlimited(), GuidanceBench::kPeriod_s, ValuesOf(X, R_start));
}

Pose StartPose(const Vector3& apex_W) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation({std::numbers::pi, 0.0, 0.0});  // the feed is -z
  X.translation() = apex_W;
  return X;
}

}  // namespace

control::GuidanceParams ScenarioGuidance() {
  control::GuidanceParams params;
  params.axis_W = Vector3::UnitZ();
  params.centre_W = Vector3::Zero();
  params.head_m = 0.022;
  return params;
}

GuidanceBench::GuidanceBench(const GuidanceBenchParams& params)
    : params_(params),
      guidance_(ScenarioGuidance(), safety::TwistLimitParams{}.max_speed_m_per_s, kPeriod_s),
      arm_(ArmAt(StartPose(Vector3::Zero()), StartPose(Vector3::Zero()).linear())) {
  if (params.method == GuidanceMethod::kOurs)
    guidance_ = control::Guidance(params.guidance, safety::TwistLimitParams{}.max_speed_m_per_s, kPeriod_s);
  law_.mass_kg.setConstant(1.7);
  law_.damping_Ns_per_m.setConstant(30.0);
  StartAt({0.0, 0.0, kStartHeight_m - params.guidance.head_m});
}

void GuidanceBench::StartAt(const Vector3& apex_W) {
  tool_ = {};
  tool_.X_WT = StartPose(apex_W);
  R_start_ = tool_.X_WT.linear();
  arm_ = ArmAt(tool_.X_WT, R_start_);
  felt_ = guidance_before_ = {};
  moved_ = V_meas_ = {};
  energy_J_ = 0.0;
  guidance_.Reset();
}

void GuidanceBench::SwitchOnAside(double aside_m) {
  StartAt({aside_m, 0.0, kStartHeight_m - params_.guidance.head_m});
}

Pose GuidanceBench::Measured() const {
  const kinematics::JointVector& q = arm_.q();
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(q.segment<3>(3)) * R_start_;
  X.translation() = q.head<3>();
  return X;
}

// Sums the wrenches of bone and guidance. The method determines by which factor the guidance is scaled, so
// that the sum keeps the limits.
// @param guidance  receives the scaled guidance
Wrench GuidanceBench::Render(const Wrench& bone, Wrench& guidance) {
  const auto sum_with = [&](const Wrench& F, double share) {
    return Wrench{.f = bone.f + share * F.f, .t = bone.t + share * F.t};
  };
  // Returns the largest factor on F, at most max_share, with which the limiter does not reduce the sum.
  const auto share_of = [&](const Wrench& F, double max_share) {
    return control::MaxFittingScale(control::ScaleWithin(limiter_, bone, F, max_share), [&](double share) {
      return limiter_.Limit(sum_with(F, share)).share >= 1.0;
    });
  };
  if (params_.method == GuidanceMethod::kOurs) {
    const double proposed = guidance_.ProposeScale({.X_WT = tool_.X_WT, .V_WT = tool_.V_WT});
    const Wrench F = guidance_.field().F_T_W;
    guidance_.AcceptScale(share_of(F, proposed));
    guidance = guidance_.scale().F_T_W();
    return sum_with(F, guidance_.scale().scale());
  }
  const bool measured = params_.method == GuidanceMethod::kMeasuredPose;
  const Wrench F = control::EvaluateGuidance(params_.guidance, measured ? Measured() : tool_.X_WT,
                                             measured ? V_meas_ : tool_.V_WT)
                       .F_T_W;
  const double share = share_of(F, 1.0);
  guidance = {.f = share * F.f, .t = share * F.t};
  return sum_with(F, share);
}

GuidanceTick GuidanceBench::Step(const HandOffset& goal, const Wrench& F_bone_T_W) {
  Wrench guidance;
  const Wrench sum = Render(limiter_.Limit(F_bone_T_W).F, guidance);
  energy_J_ += 0.5 * control::Power(guidance_before_, moved_) + 0.5 * control::Power(guidance, moved_);
  guidance_before_ = guidance;

  // Step the admittance law with the hand's wrench of the previous tick.
  const Pose X_before = tool_.X_WT;
  static_cast<void>(
      control::StepAdmittance(law_, {.f = felt_.f + sum.f, .t = felt_.t + sum.t}, kPeriod_s, tool_));
  tool_.V_WT = safety::LimitTwist(tool_.V_WT, {}).V;
  tool_.X_WT = control::IntegratePose(X_before, tool_.V_WT, kPeriod_s);
  moved_ = control::Scaled(control::TwistBetween(X_before, tool_.X_WT, kPeriod_s), kPeriod_s);

  // Step the arm, then the hand.
  const Pose X_meas_before = Measured();
  arm_.Step(ValuesOf(tool_.X_WT, R_start_));
  const Pose X_meas = Measured();
  const Twist V_meas = control::TwistBetween(X_meas_before, X_meas, kPeriod_s);
  const Vector3 lever = -params_.lever_m * X_meas.linear().col(2);
  const Vector3 at = X_meas.translation() + lever, v = V_meas.v + V_meas.w.cross(lever);
  const Vector3 v_before = V_meas_.v + V_meas_.w.cross(lever);
  const Vector3 rest_W{0.0, 0.0, kStartHeight_m - params_.guidance.head_m + params_.lever_m};
  const hil::GridHand& hand = params_.hand;
  felt_ = {};
  if (goal.holds) {
    felt_.f = hand.stiffness_N_per_m * (rest_W + goal.p_W - at) - hand.damping_Ns_per_m * v -
              hand.mass_kg / kPeriod_s * (v - v_before) + goal.push_W;
    felt_.t = lever.cross(felt_.f);
    // A hand's grip also resists rotation of the handle: the spring and damper act with a lever of 0.1 m.
    constexpr double kGrip2_m2 = 0.01;
    felt_.t -= kGrip2_m2 * (hand.stiffness_N_per_m * LogRotation(X_meas.linear() * R_start_.transpose()) +
                            hand.damping_Ns_per_m * V_meas.w);
  }
  V_meas_ = V_meas;
  return {.F_guidance_T_W = guidance,
          .hand_N = felt_.f.norm(),
          .hand_W = felt_.f,
          .speed_m_per_s = tool_.V_WT.v.norm(),
          .excess_m = control::EvaluateGuidance(params_.guidance, tool_.X_WT, {}).excess.lateral_m};
}

}  // namespace osteon::studies
