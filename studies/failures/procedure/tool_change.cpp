#include "studies/failures/procedure/tool_change.h"

#include <fmt/format.h>

#include "studies/failures/arm_bench.h"
#include "studies/failures/procedure/change_trial.h"

namespace osteon::studies {
namespace {

constexpr double kPeriod_s = 1e-3;

}  // namespace

// The baseline keeps the apex where it is: for a reamer whose diameter is 2 mm larger, it moves the flange
// back by 1 mm at once.
FailureResult RunToolChange(const FailureSetting& setting) {
  FailureResult result{.id = 32,
                       .name = "tool change",
                       .metric = "way of the flange in the tick in which the tool changes",
                       .unit = "mm",
                       .baseline_name = "the apex's pose is kept",
                       .bound = 0.0};
  const ChangeTrialParams params{.tools = {ReamerOnFlange(0.044, 0.87), ReamerOnFlange(0.046, 0.87)}};
  const ChangeTrial trial = RunChangeTrial(params);
  const kinematics::LbrArm arm(ScenarioArm());
  const Vector3 flange = arm.FlangePose(trial.q_before).translation();
  const Pose X_kept = trial.X_before * params.tools[1].X_FT.inverse();
  result.baseline = 1e3 * (X_kept.translation() - flange).norm();
  result.ours = 1e3 * (arm.FlangePose(trial.q_after).translation() - flange).norm();
  const bool same_bits = trial.q_after == trial.q_before;
  const double apex_mm = 1e3 * (trial.X_after.translation() - trial.X_before.translation()).norm();
  result.baseline_fails = result.baseline > 0.5;
  result.ours_passes = result.ours == result.bound && same_bits && !trial.fault && setting.GoesOn(1.0);
  result.note = fmt::format(
      "Reamers of 44 and 46 mm. The joints stay equal to the last bit, and the apex is {:.1f} mm further on; "
      "the baseline's flange would move at {:.0f} mm/s.",
      apex_mm, result.baseline / kPeriod_s);
  FailureSeries kept{.name = "apex kept", .x = {-2.0, -1.0, 0.0, 1.0, 2.0}},
      ours{.name = "joints kept", .ours = true};
  kept.y = {0.0, 0.0, result.baseline, result.baseline, result.baseline};
  ours.x = kept.x;
  ours.y = {0.0, 0.0, result.ours, result.ours, result.ours};
  result.plot = {.x_label = "time from the change, ms",
                 .y_label = "way of the flange, mm",
                 .series = {kept, ours},
                 .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
