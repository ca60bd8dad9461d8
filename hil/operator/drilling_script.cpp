#include "hil/operator/drilling_script.h"

#include <fmt/format.h>

#include "hil/operator/script_phases.h"

namespace osteon::hil {

HandScript MakeDrillingScript(const DrillingScriptParams& p) {
  RequireCommon(p);
  RequireInScript(p.depth_m > 0.0 && p.depth_m <= 1.0, "depth_m", p.depth_m, "0 … 1, not 0");
  RequireInScript(p.pecks >= 1 && p.pecks <= 50, "pecks", p.pecks, "1 … 50");
  RequireInScript(p.peck_height_m >= 0.0 && p.peck_height_m <= 0.1, "peck_height_m", p.peck_height_m,
                  "0 … 0.1");

  ScriptPhases phases({.seconds = p.seconds, .max_target_m_per_s = p.max_target_m_per_s},
                      {.height_m = p.start_height_m, .force_limit_N = p.approach_force_N, .grip = 0.0});
  const auto add = [&](const std::string& name, double share, double height_m, double force_N) {
    phases.Add(name, share, {.height_m = height_m, .force_limit_N = force_N});
  };
  // height of the head's centre if the tip is above_m above the surface
  const auto tip = [&](double above_m) { return above_m + p.head_radius_m; };
  // The target lies deeper than a peck's depth by this, so that the hand's spring exerts the push's force.
  const double beyond_m = p.push_force_N / p.hand_stiffness_N_per_m;
  const double peck = 0.76 / p.pecks;  // a peck's share of the script's time

  add("grasp", 0.02, p.start_height_m, p.approach_force_N);
  add("approach", 0.10, tip(0.0), p.approach_force_N);
  for (int i = 1; i <= p.pecks; ++i) {
    const double depth_m = p.depth_m * i / p.pecks;
    const bool last = i == p.pecks;
    add(fmt::format("ramp {}", i), 0.25 * peck, tip(-depth_m - beyond_m), p.push_force_N);
    add(last ? "breakthrough" : fmt::format("push {}", i), (last ? 0.75 : 0.40) * peck,
        tip(-depth_m - beyond_m), p.push_force_N);
    if (last) break;
    add(fmt::format("out {}", i), 0.20 * peck, tip(p.peck_height_m), p.approach_force_N);
    add(fmt::format("back {}", i), 0.15 * peck, tip(-depth_m), p.approach_force_N);
  }
  add("withdraw", 0.12, p.retract_height_m, p.approach_force_N);
  return HandScript(p.X_WC, p.head_radius_m, p.tool_yaw_rad, 1.0, phases.start(), phases.ReleasePhases());
}

}  // namespace osteon::hil
