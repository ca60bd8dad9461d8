#include "hil/operator/script_phases.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

namespace osteon::hil {
namespace {

constexpr double kQuinticPeakSlope = 1.875;  // of s(u), at u = 1/2

}  // namespace

void RequireInScript(bool accepted, std::string_view name, double found, std::string_view range) {
  if (!accepted)
    throw std::invalid_argument(
        fmt::format("operator's script: {}: found {}, accepted {}", name, found, range));
}

void RequireLoopPeriod(double period_s, double radius_m, double max_m_per_s) {
  const double min_period_s = 2.0 * std::numbers::pi * radius_m / max_m_per_s;
  RequireInScript(period_s > 0.0 && period_s >= min_period_s, "loop_period_s", period_s,
                  fmt::format("> 0, and {} or more: the loop at max_target_m_per_s", min_period_s));
}

ScriptPhases::ScriptPhases(const ScriptBounds& bounds, const HandKey& start)
    : bounds_(bounds), start_(start), key_(start) {}

double ScriptPhases::Reach(const ScriptBounds& bounds, double share) {
  return bounds.max_target_m_per_s * (share * bounds.seconds) / kQuinticPeakSlope;
}

void ScriptPhases::Add(std::string_view name, double share, const HandKey& wanted) {
  const double duration_s = share * bounds_.seconds;
  const double reach_m = Reach(bounds_, share);
  const double reach_rad = bounds_.max_tilt_rad_per_s * duration_s / kQuinticPeakSlope;
  key_.height_m += std::clamp(wanted.height_m - key_.height_m, -reach_m, reach_m);
  key_.tilt_rad += std::clamp(wanted.tilt_rad - key_.tilt_rad, -reach_rad, reach_rad);
  key_.swing_m += std::clamp(wanted.swing_m - key_.swing_m, -reach_m, reach_m);
  key_.force_limit_N = wanted.force_limit_N;
  key_.grip = 1.0;
  key_.done_height_m = wanted.done_height_m;
  key_.give_m_per_N = wanted.give_m_per_N;
  phases_.push_back({std::string(name), duration_s, key_});
}

}  // namespace osteon::hil
