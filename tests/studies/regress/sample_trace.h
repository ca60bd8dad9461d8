#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "studies/regress/scenario_trace.h"

namespace osteon::studies {

/// A trace of 40 ticks. Its digests begin at tick 5 and its samples are 10 ticks apart.
inline ScenarioTrace SampleTrace() {
  ScenarioTrace trace;
  trace.period_s = 1e-3;
  trace.ticks = 40;
  trace.active = 30;
  trace.hash = 0x0123456789abcdefu;
  trace.ended = "completed";
  trace.events = {{.tick = 0, .what = "state ready"},
                  {.tick = 5, .what = "state haptic"},
                  {.tick = 38, .what = "state off"}};
  trace.first_tick = 5;
  // a distinct curve for each quantity i
  const auto value = [](std::uint64_t tick, std::size_t i) {
    return std::sin(0.1 * static_cast<double>(tick) + static_cast<double>(i)) * 12.3456789012;
  };
  const std::size_t count = TraceQuantities().size();
  for (std::uint64_t tick = 5; tick < 40; ++tick) {
    TickDigest digest{};
    for (std::size_t part = 0; part < digest.size(); ++part)
      digest[part] = static_cast<std::uint16_t>((tick * 977 + part * 131) & 0xfff);
    trace.digests.push_back(digest);
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(value(tick, i));
    if (trace.least.empty()) trace.least = trace.greatest = values;
    for (std::size_t i = 0; i < count; ++i) {
      trace.least[i] = std::min(trace.least[i], values[i]);
      trace.greatest[i] = std::max(trace.greatest[i], values[i]);
    }
    if (tick % 10 == 0) trace.samples.push_back({.tick = tick, .values = values});
  }
  return trace;
}

/// Returns the index of a quantity.
inline std::size_t QuantityNamed(const std::string& name) {
  std::size_t at = 0;
  for (const TraceQuantity& quantity : TraceQuantities()) {
    if (quantity.name == name) return at;
    ++at;
  }
  throw std::invalid_argument("no quantity " + name);
}

}  // namespace osteon::studies
