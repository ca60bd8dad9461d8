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

/// Makes a plan from a caller's parameters. @throws Failure, or another exception that Guarded() turns into a
/// code.
[[nodiscard]] PlanSource MakePlan(const OsteonPlanParams& params);
[[nodiscard]] OsteonPlanInfo InfoOf(const PlanSource& plan);
/// Returns the plan's reamer with this index. @throws Failure if there is none.
[[nodiscard]] const procedure::PlannedTool& ReamerAt(const PlanSource& plan, std::uint32_t index);

/// Content of an OsteonGuidance: the same guidance as in the servo loop, with the bone's frame as the world.
/// One thread at a time.
class GuidanceTick {
 public:
  /// @throws Failure if the plan has no guidance, or a value is out of range.
  GuidanceTick(const PlanSource& plan, const OsteonGuidanceParams& params);

  /// Computes one tick. @param other  the wrench that is rendered besides the guidance; finite
  [[nodiscard]] OsteonGuidanceOutput Evaluate(const Pose& X_GT, const Twist& V_GT,
                                              const Wrench& other) noexcept;
  void SetGain(double gain) noexcept { guidance_.SetGain(gain); }
  /// @param age_s  age of the contact model, at least 0
  void SetModelAge(double age_s) noexcept { model_age_s_ = age_s; }
  void Reset() noexcept { guidance_.Reset(); }

 private:
  control::Guidance guidance_;
  safety::WrenchLimiter limiter_;
  double period_s_;
  double model_age_s_{0.0}, fade_{1.0};  // fade_: factor 0 … 1 on the guidance by the model's age
};

/// Converts an assessment and its score to the interface's struct.
[[nodiscard]] OsteonAssessment AssessmentOf(const procedure::Assessment& assessment, double axis_error_rad,
                                            double score);
[[nodiscard]] std::vector<OsteonScoreItem> ItemsOf(const procedure::Score& score);

/// Scores the figures of the bone. A session does not record time, path and hand, so these figures have no
/// points.
[[nodiscard]] procedure::Score ScoreOfCavity(const PlanSource& plan, const procedure::Assessment& assessment);

}  // namespace osteon::plugin
