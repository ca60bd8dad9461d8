#include "hil/operator/procedure_script.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "hil/operator/script_phases.h"

namespace osteon::hil {
namespace {

constexpr double kPushShare = 0.45;           // the push's share of a tool's time
constexpr std::string_view kHold = "change";  // first word of the phases in which a tool is changed

// Returns last_push_ratio, or a smaller ratio (at least 1) with which min_tool_s remains for each of the
// other tools.
double LastPushRatio(const ProcedureScriptParams& p) {
  // the time that remains if each tool gets min_tool_s, in multiples of min_tool_s
  const double spare_tool_times = p.seconds / p.min_tool_s - static_cast<double>(p.heights_m.size());
  return std::clamp(1.0 + spare_tool_times / kPushShare, 1.0, p.last_push_ratio);
}

}  // namespace

HandScript MakeProcedureScript(const ProcedureScriptParams& p) {
  RequireCommon(p);
  RequireInScript(!p.heights_m.empty(), "heights_m", 0.0, "one height for each tool");
  RequireInScript(std::abs(p.tilt_rad) <= 0.5, "tilt_rad", p.tilt_rad, "±0.5");
  RequireInScript(p.aside_m >= 0.0 && p.aside_m <= 0.02, "aside_m", p.aside_m, "0 … 0.02");
  RequireInScript(p.past_plan_m >= 0.0 && p.past_plan_m <= 0.02, "past_plan_m", p.past_plan_m, "0 … 0.02");
  RequireInScript(p.approach_m >= 0.0 && p.approach_m <= 0.1, "approach_m", p.approach_m, "0 … 0.1");
  RequireInScript(p.around_m.empty() || p.around_m.size() == p.heights_m.size(), "around_m",
                  static_cast<double>(p.around_m.size()), "none, or one for each tool");
  RequireInScript(p.last_push_ratio >= 1.0 && p.last_push_ratio <= 20.0, "last_push_ratio", p.last_push_ratio,
                  "1 … 20");
  RequireInScript(p.min_tool_s > 0.0, "min_tool_s", p.min_tool_s, "> 0");
  RequireInScript(p.coupling_N_per_m > 0.0, "coupling_N_per_m", p.coupling_N_per_m, "> 0");
  for (const double around_m : p.around_m) {
    RequireInScript(around_m >= 0.0 && around_m <= 0.05, "around_m", around_m, "0 … 0.05");
    RequireLoopPeriod(p.loop_period_s, around_m, p.max_target_m_per_s);
  }

  ScriptPhases phases(
      {.seconds = p.seconds, .max_target_m_per_s = p.max_target_m_per_s},
      {.height_m = p.start_height_m, .force_limit_N = p.approach_force_N, .tilt_rad = 0.0, .grip = 0.0});
  const double last_push_ratio = LastPushRatio(p);
  // A tool's share of the script's time. The last tool's share is larger because of its longer push.
  const double tool_share =
      1.0 / (static_cast<double>(p.heights_m.size()) + kPushShare * (last_push_ratio - 1.0));
  double done_height_m = HandKey::kNever_m;
  // An operator who sees the plan presses with the full force until the planned height is reached.
  const double past_plan_m = p.sees_plan ? p.push_force_N / p.hand_stiffness_N_per_m : p.past_plan_m;
  const auto add = [&](const std::string& name, double share, double height_m, double force_N,
                       double swing_m = 0.0) {
    phases.Add(name, share * tool_share,
               {.height_m = height_m,
                .force_limit_N = force_N,
                .tilt_rad = 0.0,
                .swing_m = swing_m,
                .done_height_m = done_height_m,
                .give_m_per_N = 1.0 / p.coupling_N_per_m});
  };
  for (std::size_t i = 0; i < p.heights_m.size(); ++i) {
    const std::string name = " " + std::to_string(i + 1);
    const double height_m = p.heights_m[i];
    if (p.sees_plan) done_height_m = height_m;
    const double above_m = i == 0 ? p.start_height_m : p.retract_height_m;
    add("grasp" + name, 0.02, above_m, p.approach_force_N);
    const double around_m = i < p.around_m.size() ? p.around_m[i] : 0.0,
                 widen_share = around_m > 0.0 ? 0.05 : 0.0;
    add("approach" + name, 0.15 - widen_share, height_m + p.approach_m, p.approach_force_N);
    if (widen_share > 0.0)
      add("widen" + name, widen_share, height_m + p.approach_m, p.approach_force_N, around_m);
    const double push_ratio = i + 1 == p.heights_m.size() ? last_push_ratio : 1.0;
    add("push" + name, 0.25, height_m - past_plan_m, p.push_force_N, around_m);
    add("finish" + name, kPushShare * push_ratio - 0.25, height_m - past_plan_m, p.push_force_N, around_m);
    add("retract" + name, 0.18, p.retract_height_m, p.push_force_N);
    add(std::string(kHold) + name, 0.20, p.retract_height_m, p.approach_force_N);
  }
  Pose X_WC = p.X_WC;
  X_WC = X_WC * Eigen::Translation3d(p.aside_m, 0.0, 0.0) * Eigen::AngleAxisd(p.tilt_rad, Vector3::UnitX());
  return HandScript(X_WC, p.head_radius_m, p.tool_yaw_rad, 2.0, phases.start(), phases.ReleasePhases(),
                    p.loop_period_s);
}

std::vector<ToolHold> HoldsForChanges(const HandScript& script) {
  std::vector<ToolHold> holds;
  double time_s = 0.0;
  for (const HandPhase& phase : script.phases()) {
    if (phase.name.starts_with(kHold)) holds.push_back({.begin_s = time_s, .length_s = phase.duration_s});
    time_s += phase.duration_s;
  }
  if (!holds.empty()) holds.pop_back();  // no tool follows the last one
  return holds;
}

}  // namespace osteon::hil
