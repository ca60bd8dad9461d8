#include "procedure/plan/surgical_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::procedure {
namespace {

// Usual difference between the implant's diameter and that of the last reamer.
constexpr double kMinPressFit_m = 1e-3, kMaxPressFit_m = 3e-3;
constexpr double kTolerance_m = 1e-6;  // planned lengths that differ by less are equal

}  // namespace

std::string SiteError(const SurgicalPlan& plan, const simulation::CutSite& site) {
  const double angle_rad = std::acos(std::clamp(plan.axis_G.dot(Vector3(site.axis).normalized()), -1.0, 1.0));
  if (angle_rad <= kMaxAxisFromSite_rad) return {};
  return fmt::format(
      "found an axis {:.1f}° off the scene's {}, accepted at most {:g}°: compare {} with the bone",
      angle_rad / kDegree, plan.kind == PlanKind::kCup ? "cup" : "opening", kMaxAxisFromSite_rad / kDegree,
      plan.kind == PlanKind::kCup ? "side and landmarks" : "it");
}

const char* RubricOf(PlanKind kind) { return kind == PlanKind::kCup ? "rubric.yaml" : "opening.yaml"; }

std::vector<std::string> WarningsOf(const SurgicalPlan& plan) {
  std::vector<std::string> warnings;
  const double last_m = plan.tools.back().diameter_m, fit_m = plan.cup_diameter_m - last_m;
  const char* kind = plan.kind == PlanKind::kCup ? "reamers" : "burrs";
  if (plan.kind == PlanKind::kCup &&
      (fit_m < kMinPressFit_m - kTolerance_m || fit_m > kMaxPressFit_m + kTolerance_m))
    warnings.push_back(fmt::format(
        "cup: found an implant {:.4g} mm wider than the last reamer ({:.4g} against {:.4g} mm), "
        "usual {:g} … {:g} mm",
        1e3 * fit_m, 1e3 * plan.cup_diameter_m, 1e3 * last_m, 1e3 * kMinPressFit_m, 1e3 * kMaxPressFit_m));
  const PlannedTool& last = plan.tools.back();
  for (const PlannedTool& tool : plan.tools) {
    // how much deeper this tool's planned apex is than that of the last tool
    const double beyond_m = last.height_m - tool.height_m + 0.5 * (tool.diameter_m - last_m);
    if (beyond_m > kTolerance_m)
      warnings.push_back(
          fmt::format("{}: the one of {:.4g} mm goes {:.3g} mm deeper than the planned cavity; it stays "
                      "within from a height of {:.4g} mm on",
                      kind, 1e3 * tool.diameter_m, 1e3 * beyond_m, 1e3 * (tool.height_m + beyond_m)));
  }
  if (std::abs(last.height_m) > kTolerance_m)
    warnings.push_back(fmt::format("{}: the last one ends {:.3g} mm {} the plan's centre, usual 0", kind,
                                   1e3 * std::abs(last.height_m), last.height_m > 0.0 ? "above" : "below"));
  return warnings;
}

}  // namespace osteon::procedure
