#include "studies/stability/grip_run.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "studies/stability/force_band.h"

namespace osteon::studies {
namespace {

// Band of the hand's RMS force, length of its window, and time from one window to the next.
constexpr double kLow_hz = 5.0, kHigh_hz = 40.0, kWindow_s = 0.2, kEvery_s = 0.02;

}  // namespace

GripRun RunGrip(const AdmittanceRunParams& params) {
  if (!(params.seconds >= 2.0))
    throw std::invalid_argument(
        fmt::format("grip run: seconds: found {:g}, accepted 2 and more", params.seconds));
  const double T = params.loop.period_s;
  const auto ticks = static_cast<std::size_t>(std::lround(params.seconds / T));
  const auto in_ticks = [T](double s) { return static_cast<std::size_t>(std::lround(s / T)); };
  AdmittanceAxis axis(params);
  GripRun run;
  std::vector<Vector3> hand_N;
  hand_N.reserve(ticks);
  double damping_sum = 0.0;
  for (std::size_t i = 0; i < ticks && run.valid; ++i) {
    const AxisTick tick = axis.Step();
    run.valid = tick.valid && std::isfinite(tick.hand_N);
    hand_N.emplace_back(tick.hand_N, 0.0, 0.0);
    run.max_index = std::max(run.max_index, tick.index);
    if (i >= in_ticks(0.5)) run.late_index = std::max(run.late_index, tick.index);
    run.max_damping = std::max(run.max_damping, tick.damping_factor);
    if (i >= in_ticks(1.0)) damping_sum += tick.damping_factor;
  }
  run.mean_damping = damping_sum / static_cast<double>(ticks - in_ticks(1.0));
  const std::size_t window = in_ticks(kWindow_s), stride = std::max<std::size_t>(1, in_ticks(kEvery_s));
  for (std::size_t i = 0; i + window <= hand_N.size(); i += stride) {
    const double effective_N = RmsInBand(hand_N, i, window, kLow_hz, kHigh_hz, T);
    run.max_N = std::max(run.max_N, effective_N);
    if (i >= in_ticks(0.5)) run.half_s_N = std::max(run.half_s_N, effective_N);
    if (i >= in_ticks(1.0)) run.one_s_N = std::max(run.one_s_N, effective_N);
    if (i + in_ticks(1.0) >= ticks) run.late_N = std::max(run.late_N, effective_N);
  }
  return run;
}

}  // namespace osteon::studies
