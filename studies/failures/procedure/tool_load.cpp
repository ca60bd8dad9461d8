#include "studies/failures/procedure/tool_load.h"

#include <algorithm>

#include <fmt/format.h>

#include "studies/failures/procedure/change_trial.h"

namespace osteon::studies {
namespace {

// Mass on the sensor with a reamer of 44 mm, and the additional mass of a reamer of 50 mm.
constexpr double kHandle_kg = 0.876, kHeavier_kg = 0.0134;
constexpr int kEvery = 20;  // ticks between two points of the picture

// Returns the speed of the apex after the resume, as a line of the picture.
FailureSeries Drawn(const char* name, const ChangeTrial& trial, bool ours) {
  FailureSeries series{.name = name, .ours = ours};
  for (std::size_t i = 0; i < trial.speed_mm_per_s.size(); i += kEvery) {
    series.x.push_back(1e-3 * static_cast<double>(i));
    series.y.push_back(trial.speed_mm_per_s[i]);
  }
  return series;
}

}  // namespace

// The baseline's loop subtracts too little weight from the sensor's reading, since the mounted tool weighs
// more. So the tool sinks.
FailureResult RunToolLoad(const FailureSetting& setting) {
  FailureResult result{.id = 33,
                       .name = "tool load",
                       .metric = "speed of a tool that nobody holds, after the change",
                       .unit = "mm/s",
                       .baseline_name = "the first tool's load stays in the loop",
                       .bound = 1.0};
  const control::LoopTool first = ReamerOnFlange(0.044, kHandle_kg);
  control::LoopTool second = ReamerOnFlange(0.050, kHandle_kg + kHeavier_kg);
  const ChangeTrialParams params{
      .tools = {first, second}, .mounted_kg = kHeavier_kg, .seconds_after = setting.full() ? 5.0 : 2.0};
  const ChangeTrial ours = RunChangeTrial(params);
  ChangeTrialParams without = params;
  without.tools[1].sensor = first.sensor;
  const ChangeTrial baseline = RunChangeTrial(without);
  result.baseline = *std::ranges::max_element(baseline.speed_mm_per_s);
  result.ours = *std::ranges::max_element(ours.speed_mm_per_s);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = result.ours <= result.bound && !ours.fault && setting.GoesOn(1.0);
  result.note = fmt::format("44 to 50 mm: {:.1f} g more, {:.2f} N against the virtual tool's drag.",
                            1e3 * kHeavier_kg, 9.81 * kHeavier_kg);
  result.plot = {
      .x_label = "time since the resume, s",
      .y_label = "speed of the apex, mm/s",
      .series = {Drawn("first tool's load", baseline, false), Drawn("new tool's load", ours, true)},
      .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
