#pragma once

#include <memory>
#include <vector>

#include "config/reading/load_surgical_plan.h"
#include "control/guidance/guidance.h"
#include "plugin/include/osteon.h"
#include "procedure/assessment/assessment.h"
#include "procedure/assessment/score.h"
#include "safety/limits.h"

namespace osteon::plugin {

/// Content of an OsteonPlan; never changes.
struct PlanSource {
  config::SurgicalPlanConfig config;
  procedure::Rubric rubric;
};

/// @throws Failure and what Guarded() knows.
[[nodiscard]] PlanSource MakePlan(const OsteonPlanParams& params);
[[nodiscard]] OsteonPlanInfo InfoOf(const PlanSource& plan);
/// @throws Failure where the plan has no such reamer.
[[nodiscard]] const procedure::PlannedTool& ReamerAt(const PlanSource& plan, std::uint32_t index);

/// Content of an OsteonGuidance: the servo loop's own guidance with the bone's frame as the world. Of one
/// thread at a time.
class GuidanceTick {
 public:
  /// @throws Failure where the plan has no guidance, or a value is out of range.
  GuidanceTick(const PlanSource& plan, const OsteonGuidanceParams& params);

  /// One tick. @param other  finite
  [[nodiscard]] OsteonGuidanceOutput Evaluate(const Pose& X_GT, const Twist& V_GT,
                                              const Wrench& other) noexcept;
  void SetGain(double gain) noexcept { guidance_.SetGain(gain); }
  /// @param age_s  of the contact model, at least 0
  void SetModelAge(double age_s) noexcept { model_age_s_ = age_s; }
  void Reset() noexcept { guidance_.Reset(); }

 private:
  control::Guidance guidance_;
  safety::WrenchLimiter limiter_;
  double period_s_;
  double model_age_s_{0.0}, fade_{1.0};  // share that the model's age leaves, as VirtualCoupling's
};

/// A score as the interface has it.
[[nodiscard]] OsteonAssessment AssessmentOf(const procedure::Assessment& assessment, double axis_error_rad,
                                            double score);
[[nodiscard]] std::vector<OsteonScoreItem> ItemsOf(const procedure::Score& score);

/// The score of what a session can tell: without time, way and hand.
[[nodiscard]] procedure::Score ScoreOfCavity(const PlanSource& plan, const procedure::Assessment& assessment);

}  // namespace osteon::plugin
