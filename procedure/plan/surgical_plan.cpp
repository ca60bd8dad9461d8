#include "procedure/plan/surgical_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.h"

namespace osteon::procedure {
namespace {

constexpr double kMinPressFit_m = 1e-3, kMaxPressFit_m = 3e-3;
constexpr double kNested_m = 1e-6;

}  // namespace

std::string SiteError(const SurgicalPlan& plan, const simulation::CutSite& site) {
  const double off_rad = std::acos(std::clamp(plan.axis_G.dot(Vector3(site.axis).normalized()), -1.0, 1.0));
  if (off_rad <= kMaxAxisFromSite_rad) return {};
  return fmt::format(
      "found an axis {:.1f}° off the scene's cup, accepted at most {:g}°: compare side and landmarks with "
      "the "
      "bone",
      off_rad / kDegree, kMaxAxisFromSite_rad / kDegree);
}

std::vector<std::string> WarningsOf(const SurgicalPlan& plan) {
  std::vector<std::string> warnings;
  const double last_m = plan.reamers.back().diameter_m, fit_m = plan.cup_diameter_m - last_m;
  if (fit_m < kMinPressFit_m - kNested_m || fit_m > kMaxPressFit_m + kNested_m)
    warnings.push_back(fmt::format(
        "cup: found an implant {:.4g} mm wider than the last reamer ({:.4g} against {:.4g} mm), "
        "usual {:g} … {:g} mm",
        1e3 * fit_m, 1e3 * plan.cup_diameter_m, 1e3 * last_m, 1e3 * kMinPressFit_m, 1e3 * kMaxPressFit_m));
  const PlannedReamer& final_reamer = plan.reamers.back();
  for (const PlannedReamer& reamer : plan.reamers) {
    const double beyond_m = final_reamer.height_m - reamer.height_m + 0.5 * (reamer.diameter_m - last_m);
    if (beyond_m > kNested_m)
      warnings.push_back(
          fmt::format("reamers: the one of {:.4g} mm goes {:.3g} mm deeper than the planned cavity; it stays "
                      "within from a height of {:.4g} mm on",
                      1e3 * reamer.diameter_m, 1e3 * beyond_m, 1e3 * (reamer.height_m + beyond_m)));
  }
  if (std::abs(final_reamer.height_m) > kNested_m)
    warnings.push_back(fmt::format("reamers: the last one ends {:.3g} mm {} the cup's centre, usual 0",
                                   1e3 * std::abs(final_reamer.height_m),
                                   final_reamer.height_m > 0.0 ? "above" : "below"));
  return warnings;
}

}  // namespace osteon::procedure
