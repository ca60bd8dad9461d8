#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plugin/src/convert.h"
#include "plugin/src/handles.h"

// The functions of osteon.h for plans, guidance and assessment.

using osteon::Pose;
using osteon::Twist;
using osteon::Wrench;
using osteon::plugin::CheckPointer;
using osteon::plugin::Fail;
using osteon::plugin::Failure;
using osteon::plugin::Guarded;
using osteon::plugin::Session;
using osteon::plugin::WithSession;

// osteon_*_default must never write more than the structs of ABI 1 hold (see osteon.cpp).
static_assert(sizeof(OsteonPlanParams) == 24 && sizeof(OsteonGuidanceParams) == 48,
              "osteon_*_default fill the structs of ABI 1");

namespace {

osteon::Vector3 VectorOf(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

bool AreFinite(const OsteonWrench& wrench) {
  return VectorOf(wrench.force_N).allFinite() && VectorOf(wrench.torque_Nm).allFinite();
}

}  // namespace

void osteon_plan_params_default(OsteonPlanParams* params) {
  if (params) *params = {};
}

OsteonResult osteon_plan_params_init(uint32_t abi, OsteonPlanParams* params) {
  return osteon::plugin::Init(abi, params, osteon_plan_params_default);
}

OsteonResult osteon_plan_create(uint32_t abi, const OsteonPlanParams* params, OsteonPlan** plan) {
  if (plan) *plan = nullptr;
  return Guarded([&] {
    osteon::plugin::CheckAbi(abi);
    osteon::plugin::CheckProcess();
    CheckPointer(params, "params");
    CheckPointer(plan, "plan");
    *plan = new OsteonPlan{osteon::plugin::MakePlan(*params)};
  });
}

void osteon_plan_destroy(OsteonPlan* plan) { delete plan; }

OsteonResult osteon_plan_info(const OsteonPlan* plan, OsteonPlanInfo* info) {
  return Guarded([&] {
    CheckPointer(plan, "plan");
    CheckPointer(info, "info");
    *info = osteon::plugin::InfoOf(plan->source);
  });
}

OsteonResult osteon_plan_reamer(const OsteonPlan* plan, uint32_t index, OsteonReamer* reamer) {
  return Guarded([&] {
    CheckPointer(plan, "plan");
    CheckPointer(reamer, "reamer");
    const auto& planned = osteon::plugin::ReamerAt(plan->source, index);
    const osteon::Vector3 center = plan->source.config.plan.CentreOf(planned);
    const osteon::Vector3 apex = plan->source.config.plan.ApexOf(planned);
    *reamer = {.diameter_m = planned.diameter_m,
               .center_m = {center.x(), center.y(), center.z()},
               .apex_m = {apex.x(), apex.y(), apex.z()}};
  });
}

void osteon_guidance_params_default(OsteonGuidanceParams* params) {
  if (params)
    *params = {.reamer = 0,
               .reserved = 0,
               .gain = -1.0,
               .max_force_N = 200.0,
               .max_torque_Nm = 20.0,
               .max_speed_m_per_s = 0.25,
               .period_s = 0.001};
}

OsteonResult osteon_guidance_params_init(uint32_t abi, OsteonGuidanceParams* params) {
  return osteon::plugin::Init(abi, params, osteon_guidance_params_default);
}

OsteonResult osteon_guidance_create(uint32_t abi, const OsteonPlan* plan, const OsteonGuidanceParams* params,
                                    OsteonGuidance** guidance) {
  if (guidance) *guidance = nullptr;
  return Guarded([&] {
    osteon::plugin::CheckAbi(abi);
    osteon::plugin::CheckProcess();
    CheckPointer(plan, "plan");
    CheckPointer(guidance, "guidance");
    OsteonGuidanceParams chosen;
    osteon_guidance_params_default(&chosen);
    if (params) chosen = *params;
    *guidance = new OsteonGuidance{osteon::plugin::GuidanceTick(plan->source, chosen)};
  });
}

void osteon_guidance_destroy(OsteonGuidance* guidance) { delete guidance; }

OsteonResult osteon_guidance_evaluate(OsteonGuidance* guidance, const OsteonPose* pose,
                                      const OsteonTwist* twist, const OsteonWrench* other,
                                      OsteonGuidanceOutput* output) {
  if (output) *output = {};
  if (!guidance || !pose || !output)
    return Fail(OSTEON_ERROR_ARGUMENT, "guidance, pose or output: found null, accepted a pointer");
  const OsteonTwist rest{};
  const OsteonTwist& moving = twist ? *twist : rest;
  const OsteonWrench none{};
  const OsteonWrench& beside = other ? *other : none;
  if (!osteon::plugin::IsUsable(*pose) || !osteon::plugin::IsFinite(moving) || !AreFinite(beside))
    return Fail(OSTEON_ERROR_ARGUMENT,
                "pose, twist or other: found a number that is not finite, a position beyond 1 km, or a "
                "quaternion of length 0, accepted finite numbers, positions within 1 km");
  *output = guidance->tick.Evaluate(osteon::plugin::ToPose(*pose), osteon::plugin::ToTwist(moving),
                                    {.f = VectorOf(beside.force_N), .t = VectorOf(beside.torque_Nm)});
  return OSTEON_OK;
}

OsteonResult osteon_guidance_set_gain(OsteonGuidance* guidance, double gain) {
  if (!guidance) return Fail(OSTEON_ERROR_ARGUMENT, "guidance: found null, accepted a pointer");
  if (!(gain >= 0.0 && gain <= 1.0))
    return Fail(OSTEON_ERROR_ARGUMENT, "gain: found a number outside, accepted 0 … 1");
  guidance->tick.SetGain(gain);
  return OSTEON_OK;
}

OsteonResult osteon_guidance_set_model_age(OsteonGuidance* guidance, double age_s) {
  if (!guidance) return Fail(OSTEON_ERROR_ARGUMENT, "guidance: found null, accepted a pointer");
  if (!(age_s >= 0.0))
    return Fail(OSTEON_ERROR_ARGUMENT, "age_s: found no number of at least 0, accepted seconds");
  guidance->tick.SetModelAge(age_s);
  return OSTEON_OK;
}

OsteonResult osteon_guidance_reset(OsteonGuidance* guidance) {
  if (!guidance) return Fail(OSTEON_ERROR_ARGUMENT, "guidance: found null, accepted a pointer");
  guidance->tick.Reset();
  return OSTEON_OK;
}

OsteonResult osteon_session_assess(OsteonSession* session, const OsteonPlan* plan,
                                   OsteonAssessment* assessment, OsteonScoreItem* items, size_t item_capacity,
                                   size_t* item_count) {
  return WithSession(session, [&](Session& s) {
    CheckPointer(plan, "plan");
    CheckPointer(assessment, "assessment");
    if (items) CheckPointer(item_count, "item_count");
    const std::size_t count = plan->source.rubric.items.size();
    if (item_count) *item_count = count;
    if (items && item_capacity < count)
      throw Failure(OSTEON_ERROR_BUFFER,
                    fmt::format("items: found room for {}, accepted the rubric's {}", item_capacity, count));
    const auto& surgical = plan->source.config.plan;
    const auto found = s.Assess(surgical);
    const auto score = osteon::plugin::ScoreOfCavity(plan->source, found);
    const auto error_rad = osteon::procedure::AxisError(surgical, found);
    *assessment = osteon::plugin::AssessmentOf(found, error_rad ? *error_rad : std::nan(""), score.total);
    if (items) std::ranges::copy(osteon::plugin::ItemsOf(score), items);
  });
}
