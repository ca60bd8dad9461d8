#include "procedure/assessment/assessment.h"

#include <algorithm>
#include <cmath>

namespace osteon::procedure {

void AssessBone(const SurgicalPlan& plan, const simulation::Bone& uncut, const simulation::CarvedState& state,
                Assessment& assessment) {
  assessment.cavity = AssessCavity(plan, uncut, state);
  if (plan.kind == PlanKind::kOpening) assessment.opening = AssessOpening(plan, uncut, state);
}

std::optional<double> AxisError(const SurgicalPlan& plan, const Assessment& assessment) {
  if (!assessment.axis_G) return std::nullopt;
  // the arctangent of sine and cosine, because an arccosine cannot resolve angles below 1e-8 rad
  return std::atan2(plan.axis_G.cross(*assessment.axis_G).norm(), plan.axis_G.dot(*assessment.axis_G));
}

MetricValues ValuesOf(const SurgicalPlan& plan, const Assessment& assessment) {
  const CavityResult& cavity = assessment.cavity;
  const ProcessFigures& process = assessment.process;
  MetricValues values{{"over_reamed", cavity.over_m3},
                      {"under_reamed", cavity.under_m3},
                      {"time", process.time_s},
                      {"cutting_time", process.cutting_s},
                      {"path", process.path_m},
                      {"force_mean", process.force_mean_N},
                      {"force_peak", process.force_peak_N},
                      {"wrong_way", process.wrong_way},
                      {"outside", process.outside_s},
                      {"tremor", process.tremor_N}};
  if (plan.kind == PlanKind::kCup) values["coverage"] = cavity.coverage;
  if (const auto& opening = assessment.opening) {
    if (opening->shift_m) values["opening_shift"] = *opening->shift_m;
    if (opening->depth_error_m) values["depth_error"] = std::abs(*opening->depth_error_m);
    if (opening->unroofed) values["unroofed"] = *opening->unroofed;
  }
  if (const auto error_rad = AxisError(plan, assessment)) values["axis_error"] = *error_rad;
  if (cavity.fit) {
    values["superior_shift"] = std::abs(cavity.from_native.superior_m);
    values["medial_shift"] = std::abs(cavity.from_native.medial_m);
    values["posterior_shift"] = std::abs(cavity.from_native.posterior_m);
    values["diameter_error"] = std::abs(2.0 * (cavity.fit->radius_m - plan.cavity().radius_m));
    values["form_p95"] = cavity.fit->residual_p95_m;
  }
  if (cavity.cartilage_left) values["cartilage_left"] = *cavity.cartilage_left;
  if (cavity.rim_preserved) values["rim_preserved"] = *cavity.rim_preserved;
  return values;
}

std::vector<PublishedShift> PublishedShifts(const Assessment& assessment) {
  constexpr const char* kSource = "PMID 27909120";
  if (!assessment.cavity.fit) return {};
  const AnatomicShift& shift = assessment.cavity.from_native;
  return {{"medial", shift.medial_m, {0.8e-3, 1.4e-3}, {5.0e-3, 3.3e-3}, kSource},
          {"superior", shift.superior_m, {0.7e-3, 1.3e-3}, {3.7e-3, 2.6e-3}, kSource}};
}

}  // namespace osteon::procedure
