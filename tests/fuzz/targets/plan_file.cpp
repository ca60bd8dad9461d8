#include <cmath>

#include "config/reading/load_rubric.h"
#include "config/reading/load_surgical_plan.h"
#include "session/procedure/plan_guidance.h"
#include "tests/fuzz/targets/config_claims.h"

// Fuzz target: a surgical plan, and a rubric for the scores of sessions. The input is read as both.

namespace osteon::fuzz {
namespace {

void ClaimPlan(const config::SurgicalPlanConfig& config) {
  const procedure::SurgicalPlan& plan = config.plan;
  Claim(std::abs(plan.axis_G.norm() - 1.0) < 1e-9, "the axis is a direction");
  Claim(!plan.tools.empty(), "a plan has a tool");
  double before_m = 0.0;
  for (const procedure::PlannedTool& tool : plan.tools) {
    Claim(tool.diameter_m > before_m, "diameters rise");
    before_m = tool.diameter_m;
    Claim(tool.around_m >= 0.0 && plan.ApexOf(tool).allFinite(), "a tool has a place");
    // throws if the servo loop would refuse a gain of the guidance
    (void)session::GuidanceOf(plan, tool, Pose::Identity());
  }
  Claim(procedure::SiteError(plan, config.site).empty(), "the plan fits its bone");
}

void ClaimRubric(const procedure::Rubric& rubric) {
  double points = 0.0;
  for (const procedure::RubricItem& item : rubric.items) {
    const bool more = procedure::MetricNamed(item.metric).more_is_better;
    Claim(more ? item.zero < item.full : item.zero > item.full, "no item gains by a larger error");
    points += item.weight;
  }
  Claim(points <= 100.0 + 1e-9, "there are 100 points at most");
  const double best = procedure::ScoreOf(rubric, {}, std::nullopt).total;
  Claim(best == 0.0, "what was not measured has no points");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  const fuzz::YamlInput input(data, size);
  if (const auto plan = input.Read(config::LoadSurgicalPlan)) fuzz::ClaimPlan(*plan);
  if (const auto rubric = input.Read(config::LoadRubric)) fuzz::ClaimRubric(*rubric);
  return 0;
}
