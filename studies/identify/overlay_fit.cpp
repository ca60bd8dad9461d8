#include "studies/identify/overlay_fit.h"

#include <cmath>
#include <numbers>

namespace osteon::app {
namespace {

// Half width relative to the value.
double Relative(const Estimate& estimate) { return estimate.half_width / std::abs(estimate.value); }

Estimate With(double value, double relative) { return {value, std::abs(value) * relative}; }

}  // namespace

OverlayFit OverlayOf(const ServoFit& fit, double nominal_N_per_m) {
  const double w = 2.0 * std::numbers::pi * fit.bandwidth_hz.value;
  const double stiffness = nominal_N_per_m / fit.gain.value;
  const double by_gain = Relative(fit.gain), by_w = Relative(fit.bandwidth_hz);
  return {.stiffness_N_per_m = With(stiffness, by_gain),
          .damping_Ns_per_m = With(2.0 * fit.damping_ratio.value * stiffness / w,
                                   std::hypot(by_gain, by_w, Relative(fit.damping_ratio))),
          .mass_kg = With(stiffness / (w * w), std::hypot(by_gain, 2.0 * by_w)),
          .dead_time_s = fit.dead_time_s};
}

MeasuredResponse PerForce(MeasuredResponse response, double nominal_N_per_m) {
  for (ResponseLine& line : response.lines) {
    line.value /= nominal_N_per_m;
    line.noise_sd /= nominal_N_per_m;
    line.sd /= nominal_N_per_m;
  }
  return response;
}

}  // namespace osteon::app
