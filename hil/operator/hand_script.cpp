#include "hil/operator/hand_script.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/operator/quintic.h"
#include "hil/operator/script_phases.h"

namespace osteon::hil {
namespace {

// An interpolated value, and its rate of change per second.
struct ValueAndRate {
  double value, rate;
};

// Interpolates from the value at a phase's beginning to that at its end, by a blend over the phase's
// `duration_s`.
ValueAndRate Interpolate(double from, double to, Blend b, double duration_s) {
  return {from + (to - from) * b.s, (to - from) * b.slope / duration_s};
}

// Angular velocity, in the fixed frame, of Exp(r(t)): w = J(r) r', J the left Jacobian of SO(3).
Vector3 AngularVelocity(const Vector3& r, const Vector3& rdot) {
  const double angle = r.norm();
  if (angle < 1e-6) return rdot + 0.5 * r.cross(rdot);  // next term: angle^2 / 6, below 1e-12
  const Vector3 axis = r / angle;
  const double c = std::sin(angle) / angle;
  return c * rdot + (1.0 - c) * axis.dot(rdot) * axis + (1.0 - std::cos(angle)) / angle * axis.cross(rdot);
}

}  // namespace

HandScript::HandScript(const Pose& X_WC, double head_radius_m, double tool_yaw_rad, double whirl_period_s,
                       const HandKey& start, std::vector<HandPhase> phases, double swing_period_s)
    : X_WC_(X_WC),
      head_radius_m_(head_radius_m),
      whirl_rad_per_s_(2.0 * std::numbers::pi / whirl_period_s),
      swing_rad_per_s_(2.0 * std::numbers::pi / swing_period_s),
      start_(start),
      phases_(std::move(phases)) {
  RequireInScript(head_radius_m > 0.0, "head_radius_m", head_radius_m, "> 0");
  RequireInScript(whirl_period_s > 0.0, "whirl_period_s", whirl_period_s, "> 0");
  RequireInScript(swing_period_s > 0.0, "swing_period_s", swing_period_s, "> 0");
  const auto check = [this](const HandKey& key) {
    RequireInScript(key.swing_m >= 0.0 && std::isfinite(key.swing_m), "swing_m", key.swing_m, ">= 0");
    swings_ |= key.swing_m > 0.0;
    RequireInScript(key.grip >= 0.0 && key.grip <= 1.0, "grip", key.grip, "0 … 1");
    RequireInScript(key.force_limit_N >= 0.0, "force_limit_N", key.force_limit_N, ">= 0");
    RequireInScript(std::isfinite(key.height_m) && std::isfinite(key.tilt_rad), "height_m, tilt_rad",
                    key.height_m + key.tilt_rad, "finite values");
  };
  check(start);
  for (const HandPhase& phase : phases_) {
    RequireInScript(phase.duration_s > 0.0, "duration_s of phase " + phase.name, phase.duration_s, "> 0");
    check(phase.end);
    duration_s_ += phase.duration_s;
  }
  RequireInScript(start_.swing_m == 0.0, "swing_m at the start", start_.swing_m, "0");
  if (!phases_.empty())
    RequireInScript(phases_.back().end.swing_m == 0.0, "swing_m at the end", phases_.back().end.swing_m, "0");
  R_WT_upright_ = X_WC.linear() * (Eigen::AngleAxisd(std::numbers::pi, Vector3::UnitX()) *
                                   Eigen::AngleAxisd(tool_yaw_rad, Vector3::UnitZ()))
                                      .toRotationMatrix();
}

HandTarget HandScript::Sample(double time_s) const noexcept {
  // find the phase and the time since its beginning
  double elapsed_s = std::max(time_s, 0.0);
  HandKey from = start_, to = start_;
  Blend blend{1.0, 0.0};
  double duration_s = 1.0;
  for (const HandPhase& phase : phases_) {
    from = to;
    to = phase.end;
    if (elapsed_s < phase.duration_s) {
      blend = Quintic(elapsed_s / phase.duration_s);
      duration_s = phase.duration_s;
      break;
    }
    elapsed_s -= phase.duration_s;
  }
  const ValueAndRate height = Interpolate(from.height_m, to.height_m, blend, duration_s);
  const ValueAndRate tilt = Interpolate(from.tilt_rad, to.tilt_rad, blend, duration_s);

  // orientation: the tilt is the rotation vector r, whose direction in T's xy plane is the whirl's angle p
  const double p = whirl_rad_per_s_ * std::clamp(time_s, 0.0, duration_s_);
  const double p_rate = time_s > 0.0 && time_s < duration_s_ ? whirl_rad_per_s_ : 0.0;
  const Vector3 u{std::cos(p), std::sin(p), 0.0}, u_normal{-std::sin(p), std::cos(p), 0.0};
  const Vector3 r = tilt.value * u;
  const Vector3 r_rate = tilt.rate * u + tilt.value * p_rate * u_normal;

  HandTarget target;
  target.X_WT.linear() = R_WT_upright_ * ExpRotation(r);
  target.V_WT.w = R_WT_upright_ * AngularVelocity(r, r_rate);

  // position: the head's centre lies on the site's axis; the apex is one radius further along T's z
  const Vector3 axis_W = X_WC_.linear().col(2);
  const Vector3 p_center_apex_W = head_radius_m_ * target.X_WT.linear().col(2);
  target.X_WT.translation() = X_WC_.translation() + height.value * axis_W + p_center_apex_W;
  target.V_WT.v = height.rate * axis_W + target.V_WT.w.cross(p_center_apex_W);

  // The swing moves the head's centre on a circle about the site's axis, at angle q. Before and after the
  // script the circle's radius and its rate are zero, so the angular rate has no effect there.
  if (swings_) {
    const ValueAndRate swing = Interpolate(from.swing_m, to.swing_m, blend, duration_s);
    const double q = swing_rad_per_s_ * std::clamp(time_s, 0.0, duration_s_);
    const Vector3 out_C{std::cos(q), std::sin(q), 0.0}, on_C{-std::sin(q), std::cos(q), 0.0};
    target.X_WT.translation() += X_WC_.linear() * (swing.value * out_C);
    target.V_WT.v += X_WC_.linear() * (swing.rate * out_C + swing.value * swing_rad_per_s_ * on_C);
  }

  target.height_m = height.value;
  target.force_limit_N = Interpolate(from.force_limit_N, to.force_limit_N, blend, duration_s).value;
  target.grip = Interpolate(from.grip, to.grip, blend, duration_s).value;
  // these values are settings of a phase, not motions of the hand, so they change at once when the phase
  // begins
  target.done_height_m = to.done_height_m;
  target.give_m_per_N = to.give_m_per_N;
  return target;
}

const char* HandScript::PhaseName(double time_s) const noexcept {
  for (const HandPhase& phase : phases_) {
    if (time_s < phase.duration_s) return phase.name.c_str();
    time_s -= phase.duration_s;
  }
  return "done";
}

HandScript MakeReamingScript(const ReamingScriptParams& p) {
  RequireCommon(p);
  RequireInScript(p.full_force_depth_m >= 0.0, "full_force_depth_m", p.full_force_depth_m, ">= 0");
  RequireInScript(std::abs(p.tilt_rad) <= 0.5, "tilt_rad", p.tilt_rad, "±0.5");
  RequireInScript(p.max_tilt_rad_per_s > 0.0, "max_tilt_rad_per_s", p.max_tilt_rad_per_s, "> 0");

  ScriptPhases phases(
      {.seconds = p.seconds,
       .max_target_m_per_s = p.max_target_m_per_s,
       .max_tilt_rad_per_s = p.max_tilt_rad_per_s},
      {.height_m = p.start_height_m, .force_limit_N = p.approach_force_N, .tilt_rad = 0.0, .grip = 0.0});
  // Adds a phase that takes this share of the script's time.
  const auto add = [&](const char* name, double time_share, double height_m, double force_N,
                       double tilt_rad) {
    phases.Add(name, time_share, {.height_m = height_m, .force_limit_N = force_N, .tilt_rad = tilt_rad});
  };
  // The hand's target lies below the depth of full force, so that the hand's spring exerts push_force_N at
  // that depth.
  const double push_height_m = -(p.full_force_depth_m + p.push_force_N / p.hand_stiffness_N_per_m);
  add("grasp", 0.02, p.start_height_m, p.approach_force_N, 0.0);
  add("approach", 0.08, 0.0, p.approach_force_N, 0.0);
  add("ramp", 0.07, push_height_m, p.push_force_N, 0.0);
  const bool straight = p.tilt_rad == 0.0;
  add(straight ? "press" : "tilt", 0.08, push_height_m, p.push_force_N, p.tilt_rad);
  // keep the tilt that the previous phase has reached, which may be less than tilt_rad because of
  // max_tilt_rad_per_s
  add(straight ? "press" : "whirlwind", 0.55, push_height_m, p.push_force_N, phases.key().tilt_rad);
  add(straight ? "press" : "upright", 0.08, push_height_m, p.push_force_N, 0.0);
  add("unload", 0.04, 0.0, p.approach_force_N, 0.0);
  add("retract", 0.08, p.retract_height_m, p.approach_force_N, 0.0);
  return HandScript(p.X_WC, p.head_radius_m, p.tool_yaw_rad, p.whirl_period_s, phases.start(),
                    phases.ReleasePhases());
}

}  // namespace osteon::hil
