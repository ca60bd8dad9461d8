#include "plugin/src/plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "config/reading/load_rubric.h"
#include "control/coupling/virtual_coupling.h"
#include "plugin/src/convert.h"
#include "plugin/src/result.h"
#include "plugin/src/shipped_files.h"
#include "safety/watchdog.h"
#include "session/procedure/plan_guidance.h"

namespace osteon::plugin {
namespace {

// largest values that a caller may set for the guidance
constexpr double kMaxTorque_Nm = 20.0, kMaxSpeed_m_per_s = 10.0, kMaxPeriod_s = 0.1;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();  // a figure that was not measured

/// Returns the value. @throws Failure if it is not above 0 and at most `most`.
double InRange(const char* name, double value, double most) {
  if (!(value > 0.0 && value <= most))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("{}: found {}, accepted above 0, at most {}", name, value, most));
  return value;
}

void Copy(const Vector3& from, double (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

/// The plan's guidance for the chosen reamer, with the caller's gain.
/// @throws Failure if the plan has none, or the gain is out of range.
control::GuidanceParams GuidanceParamsOf(const PlanSource& plan, const OsteonGuidanceParams& params) {
  const procedure::SurgicalPlan& surgical = plan.config.plan;
  auto guidance = session::GuidanceOf(surgical, ReamerAt(plan, params.reamer), Pose::Identity());
  if (!guidance)
    throw Failure(OSTEON_ERROR_STATE,
                  fmt::format("plan {}: found no guidance, accepted a plan with `guidance:`", surgical.name));
  if (!(params.gain <= 1.0))
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("gain: found {}, accepted at most 1 (negative: the plan's own)", params.gain));
  if (params.gain >= 0.0) guidance->gain = params.gain;
  return *guidance;
}

/// Returns the planned cup's angles by one of the three definitions.
OsteonCupAngles AnglesIn(procedure::CupDefinition definition, const procedure::SurgicalPlan& plan) {
  const procedure::CupAngles angles = procedure::AnglesOf(definition, plan.pelvis.FromG(plan.axis_G));
  return {.inclination_rad = angles.inclination_rad, .anteversion_rad = angles.anteversion_rad};
}

}  // namespace

PlanSource MakePlan(const OsteonPlanParams& params) {
  const std::filesystem::path config = ConfigFolder(params.config_folder);
  PlanSource plan{.config = config::LoadSurgicalPlan(
                      FindShipped(config, "plans", params.plan ? params.plan : "acetabulum")),
                  .rubric = {}};
  const std::string own = std::filesystem::path(procedure::RubricOf(plan.config.plan.kind)).stem().string();
  plan.rubric = config::LoadRubric(FindShipped(config, "rubrics", params.rubric ? params.rubric : own));
  return plan;
}

OsteonPlanInfo InfoOf(const PlanSource& plan) {
  using procedure::CupDefinition;
  const procedure::SurgicalPlan& from = plan.config.plan;
  OsteonPlanInfo info{};
  Copy(from.centre_m, info.cup_center_m);
  Copy(from.axis_G, info.cup_axis);
  info.cup_diameter_m = from.cup_diameter_m;
  Copy(from.native_centre_m, info.native_center_m);
  if (from.kind == procedure::PlanKind::kCup) {
    info.radiographic = AnglesIn(CupDefinition::kRadiographic, from);
    info.operative = AnglesIn(CupDefinition::kOperative, from);
    info.anatomic = AnglesIn(CupDefinition::kAnatomic, from);
  } else {
    std::ranges::fill(info.native_center_m, kUnknown);
    info.radiographic = info.operative = info.anatomic = {kUnknown, kUnknown};
  }
  info.reamer_count = static_cast<std::uint32_t>(from.tools.size());
  info.is_left = from.side == procedure::Side::kLeft ? 1 : 0;
  info.has_guidance = session::GuidanceOf(from, from.tools.front(), Pose::Identity()) ? 1 : 0;
  return info;
}

const procedure::PlannedTool& ReamerAt(const PlanSource& plan, std::uint32_t index) {
  const auto& reamers = plan.config.plan.tools;
  if (index >= reamers.size())
    throw Failure(OSTEON_ERROR_ARGUMENT,
                  fmt::format("reamer: found {}, accepted 0 … {}", index, reamers.size() - 1));
  return reamers[index];
}

GuidanceTick::GuidanceTick(const PlanSource& plan, const OsteonGuidanceParams& params)
    : guidance_(GuidanceParamsOf(plan, params),
                InRange("max_speed_m_per_s", params.max_speed_m_per_s, kMaxSpeed_m_per_s),
                InRange("period_s", params.period_s, kMaxPeriod_s)),
      limiter_({.max_force_N = InRange("max_force_N", params.max_force_N, safety::kForceCeiling_N),
                .max_torque_Nm = InRange("max_torque_Nm", params.max_torque_Nm, kMaxTorque_Nm)}),
      period_s_(params.period_s) {}

OsteonGuidanceOutput GuidanceTick::Evaluate(const Pose& X_GT, const Twist& V_GT,
                                            const Wrench& other) noexcept {
  // fades by the default ages, because there is no cell file that could change them
  constexpr control::CouplingParams kCoupling;
  // the fade falls at once with the model's age, and rises to 1 within ramp_s at the fastest
  fade_ = std::min(safety::AgeFade(model_age_s_, kCoupling.fresh_s, kCoupling.gone_s),
                   fade_ + period_s_ / kCoupling.ramp_s);
  const double proposed = guidance_.ProposeScale({.X_WT = X_GT, .V_WT = V_GT, .model_fade = fade_});
  const control::GuidanceField& field = guidance_.field();
  const Wrench& F = field.F_T_W;
  // Whether the sum of `other` and this share of the guidance's wrench is within the limits, computed with
  // the same rounding as in the servo loop.
  const auto fits = [&](double share) {
    return limiter_.Limit({.f = other.f + share * F.f, .t = other.t + share * F.t}).share >= 1.0;
  };
  guidance_.AcceptScale(
      field.inside ? proposed
                   : control::MaxFittingScale(control::ScaleWithin(limiter_, other, F, proposed), fits));
  OsteonGuidanceOutput output{};
  output.cone_rad = field.excess.cone_rad;
  output.lateral_m = field.excess.lateral_m;
  output.depth_m = field.excess.depth_m;
  output.inside = field.inside ? 1 : 0;
  output.stop_spindle = guidance_.stops_spindle() ? 1 : 0;
  output.potential_J = field.potential_J;
  if (guidance_.trips()) {
    guidance_.Reset();
    output.jumped = 1;
    return output;
  }
  output.share = guidance_.scale().scale();
  output.energy_J = guidance_.scale().energy_J();
  output.wrench = FromWrench(guidance_.scale().F_T_W());
  return output;
}

OsteonAssessment AssessmentOf(const procedure::Assessment& found, double axis_error_rad, double score) {
  const procedure::CavityResult& cavity = found.cavity;
  OsteonAssessment result{};
  result.score = score;
  result.axis_error_rad = axis_error_rad;
  // these figures are unknown without a fitted sphere
  for (double* each :
       {&result.diameter_m, &result.diameter_sd_m, &result.center_m[0], &result.center_m[1],
        &result.center_m[2], &result.form_p95_m, &result.medial_m, &result.superior_m, &result.posterior_m,
        &result.native_medial_m, &result.native_superior_m, &result.native_posterior_m})
    *each = kUnknown;
  if (cavity.fit) {
    result.diameter_m = 2.0 * cavity.fit->radius_m;
    result.diameter_sd_m = 2.0 * cavity.fit->radius_sd_m;
    Copy(cavity.fit->centre_m, result.center_m);
    result.form_p95_m = cavity.fit->residual_p95_m;
    result.medial_m = cavity.from_plan.medial_m;
    result.superior_m = cavity.from_plan.superior_m;
    result.posterior_m = cavity.from_plan.posterior_m;
    result.native_medial_m = cavity.from_native.medial_m;
    result.native_superior_m = cavity.from_native.superior_m;
    result.native_posterior_m = cavity.from_native.posterior_m;
  }
  result.coverage = found.opening ? kUnknown : cavity.coverage;
  result.removed_m3 = cavity.removed_m3;
  result.over_m3 = cavity.over_m3;
  result.under_m3 = cavity.under_m3;
  result.cartilage_left = cavity.cartilage_left.value_or(kUnknown);
  result.rim_preserved = cavity.rim_preserved.value_or(kUnknown);
  result.min_wall_m = found.min_wall_m.value_or(kUnknown);
  return result;
}

std::vector<OsteonScoreItem> ItemsOf(const procedure::Score& score) {
  std::vector<OsteonScoreItem> items;
  for (const procedure::ScoredItem& scored : score.items) {
    const procedure::Metric& metric = procedure::MetricNamed(scored.item.metric);
    OsteonScoreItem item{};
    (void)std::snprintf(item.metric, sizeof item.metric, "%s", scored.item.metric.c_str());
    (void)std::snprintf(item.unit, sizeof item.unit, "%s", metric.unit);
    item.value = scored.value ? *scored.value * metric.to_unit : kUnknown;
    item.full = scored.item.full * metric.to_unit;
    item.zero = scored.item.zero * metric.to_unit;
    item.weight = scored.item.weight;
    item.points = scored.points;
    items.push_back(item);
  }
  return items;
}

procedure::Score ScoreOfCavity(const PlanSource& plan, const procedure::Assessment& assessment) {
  procedure::MetricValues values = procedure::ValuesOf(plan.config.plan, assessment);
  // remove the figures of time, path and hand, which a session does not record
  for (const char* process :
       {"time", "cutting_time", "path", "force_mean", "force_peak", "wrong_way", "outside", "tremor"})
    values.erase(process);
  return procedure::ScoreOf(plan.rubric, values, assessment.min_wall_m);
}

}  // namespace osteon::plugin
