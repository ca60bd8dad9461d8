#pragma once

#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>

#include "config/reading/load.h"
#include "config/reading/load_identified.h"
#include "studies/stability/measured_loop.h"

namespace osteon::studies {

/// The result that a perfect identification of an arm with the response `truth` would write for a cell: the
/// response along z in 20 lines, a hand, a sensor and a link.
inline config::IdentifiedCell IdentifiedOf(const config::CellConfig& cell, const ResponseModel& truth) {
  config::IdentifiedCell identified;
  identified.valid_for = {
      .robot = cell.robot.name, .tool = cell.tool.tool.name, .period_s = cell.servo.period_s};
  for (int i = 0; i < 7; ++i) identified.valid_for.start_rad[static_cast<std::size_t>(i)] = cell.start.q[i];
  config::IdentifiedArm arm{.axis = "z", .speed_m_per_s = 0.02};
  arm.bandwidth_hz = truth.arm.bandwidth_hz;
  arm.damping_ratio = truth.arm.damping_ratio;
  arm.dead_time_s = truth.arm.dead_cycles * cell.servo.period_s;
  arm.lag_s = arm.dead_time_s + 2.0 * arm.damping_ratio / (2.0 * std::numbers::pi * arm.bandwidth_hz);
  const auto around = [](double value) { return config::IdentifiedInterval{0.99 * value, 1.01 * value}; };
  arm.bandwidth_interval_hz = around(arm.bandwidth_hz);
  arm.damping_interval = around(arm.damping_ratio);
  arm.dead_time_interval_s = around(arm.dead_time_s);
  arm.lag_interval_s = around(arm.lag_s);
  identified.arm = {arm};
  config::IdentifiedResponse response{
      .axis = "z", .speed_m_per_s = 0.02, .by_force = !truth.structure.empty()};
  for (int i = 0; i < 20; ++i) {
    const double hz = 0.5 * std::pow(2.0, 6.8 * i / 19.0);
    const std::complex<double> value = ModelResponse(truth, hz);
    response.lines.push_back({.hz = hz, .re = value.real(), .im = value.imag(), .sd = 1e-4});
  }
  identified.response = {response};
  for (const StructureResonance& resonance : truth.structure)
    identified.structure.push_back({.hz = resonance.hz, .damping_ratio = resonance.damping_ratio});
  identified.sensor = config::IdentifiedSensor{.delay_s = 1e-3, .noise_N = 0.08, .drift_N = 0.05};
  identified.link =
      config::IdentifiedLink{.jitter_mean_s = 0.1e-3, .jitter_p99_s = 0.3e-3, .loss_ratio = 0.001};
  identified.hands = {{.name = "mine",
                       .stiffness_N_per_m = 2000.0,
                       .stiffness_interval_N_per_m = {.low = 1900.0, .high = 2100.0},
                       .damping_Ns_per_m = 25.0,
                       .mass_kg = 1.5}};
  return identified;
}

}  // namespace osteon::studies
