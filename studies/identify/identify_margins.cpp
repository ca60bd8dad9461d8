#include "studies/identify/identify_margins.h"

#include <algorithm>
#include <vector>

namespace osteon::studies {
namespace {

// The arm along an axis for the stability analysis of the loop: the response by the encoders, and the fitted
// model.
MeasuredPlant PlantOf(const AxisResult& axis, double period_s) {
  std::vector<PlantLine> lines;
  for (const ResponseLine& line : axis.by_encoders.lines)
    lines.push_back({.hz = line.hz, .value = line.value, .sd = line.sd});
  const ServoModel& model = axis.fit.model;
  return {lines,
          {.arm = {.bandwidth_hz = model.bandwidth_hz,
                   .damping_ratio = model.damping_ratio,
                   .dead_cycles = std::max(0.0, model.dead_time_s / period_s)},
           .period_s = period_s}};
}

}  // namespace

std::optional<double> CrossingOf(const config::CellConfig& cell, const AxisResult& axis) {
  if (cell.servo.law == control::Law::kImpedance || axis.by_encoders.lines.size() < 2) return {};
  const TuneTask task = MeasuredTaskOf(cell);
  const MeasuredPlant plant = PlantOf(axis, task.loop.period_s);
  MeasuredLoopParams params{.loop = task.loop, .sensor_delay_s = task.loop.sensor_delay * task.loop.period_s};
  std::optional<double> crossing_hz;
  for (const hil::GridHand& hand : HandsUpTo(task.human_grip_N_per_m)) {
    params.loop.hand = hand;
    for (const NyquistPoint& point : NyquistCurve(plant, params))
      if (std::abs(point.loop) >= 1.0) crossing_hz = std::max(crossing_hz.value_or(0.0), point.hz);
  }
  return crossing_hz;
}

void JudgeGains(const config::CellConfig& cell, IdentifyResult& result) {
  const bool has_arm =
      std::ranges::any_of(result.axes, [](const AxisResult& axis) { return !axis.request.held; });
  if (cell.servo.law == control::Law::kImpedance || !has_arm || !result.refused.empty()) return;
  config::CellConfig measured = cell;
  measured.identified = ToIdentified(result);
  const TuneTask task = MeasuredTaskOf(measured);
  if (!task.response) return;
  const TuneGains own{.mass_kg = task.loop.mass_kg, .damping_Ns_per_m = task.loop.damping_Ns_per_m};
  result.margins = MeasuredMargins(task, "own", own, HandsUpTo(task, task.human_grip_N_per_m));
  result.nyquist_svg = NyquistSvg(task, own, own, result.margins);
}

}  // namespace osteon::studies
