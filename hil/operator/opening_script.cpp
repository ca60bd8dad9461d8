#include "hil/operator/opening_script.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/operator/script_phases.h"

namespace osteon::hil {

HandScript MakeOpeningScript(const OpeningScriptParams& p) {
  RequireCommon(p);
  RequireInScript(p.depth_m > 0.0 && p.depth_m <= 1.0, "depth_m", p.depth_m, "0 … 1, not 0");
  RequireInScript(p.site_radius_m >= p.head_radius_m && p.site_radius_m <= 1.0, "site_radius_m",
                  p.site_radius_m, fmt::format("the head's {} … 1", p.head_radius_m));
  RequireInScript(p.turns >= 1 && p.turns <= 50, "turns", p.turns, "1 … 50");
  const double widest_m = p.site_radius_m - p.head_radius_m;
  RequireLoopPeriod(p.loop_period_s, widest_m, p.max_target_m_per_s);

  // In a short script, the loops' radius is limited to that from which the hand can return to the axis within
  // kToAxis of the time.
  constexpr double kToAxis = 0.08;  // share of the script's time
  const ScriptBounds bounds{.seconds = p.seconds, .max_target_m_per_s = p.max_target_m_per_s};
  const double swing_m = std::min(widest_m, ScriptPhases::Reach(bounds, kToAxis));

  ScriptPhases phases(bounds,
                      {.height_m = p.start_height_m, .force_limit_N = p.approach_force_N, .grip = 0.0});
  const auto add = [&](const std::string& name, double share, double height_m, double force_N, double swing) {
    phases.Add(name, share, {.height_m = height_m, .force_limit_N = force_N, .swing_m = swing});
  };
  // height of the head's centre with the apex at this share of the depth, minus the extra depth that makes
  // the hand push
  const double beyond_m = p.push_force_N / p.hand_stiffness_N_per_m;
  const auto push = [&](double share_of_depth) {
    return p.head_radius_m - share_of_depth * p.depth_m - beyond_m;
  };
  constexpr double kStraightIn = 0.3;  // share of the depth that is reached before the loops begin

  add("grasp", 0.02, p.start_height_m, p.approach_force_N, 0.0);
  add("approach", 0.13, p.head_radius_m, p.approach_force_N, 0.0);
  add("in", 0.15, push(kStraightIn), p.push_force_N, 0.0);
  for (int i = 1; i <= p.turns; ++i) {
    const double share = static_cast<double>(i) / p.turns;
    add(fmt::format("widen {}", i), 0.40 / p.turns, push(kStraightIn + (1.0 - kStraightIn) * share),
        p.push_force_N, share * swing_m);
  }
  add("round", 0.12, push(1.0), p.push_force_N, swing_m);
  add("to the axis", kToAxis, p.head_radius_m - kStraightIn * p.depth_m, p.approach_force_N, 0.0);
  add("out", 0.10, p.retract_height_m, p.approach_force_N, 0.0);
  return HandScript(p.X_WC, p.head_radius_m, p.tool_yaw_rad, 1.0, phases.start(), phases.ReleasePhases(),
                    p.loop_period_s);
}

}  // namespace osteon::hil
