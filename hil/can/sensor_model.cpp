#include "hil/can/sensor_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace osteon::hil {

SensorModel::SensorModel(const SensorModelParams& params) : params_(params), random_(params.seed) {
  if (!(params.noise_N >= 0.0) || !(params.noise_Nm >= 0.0) || !(params.range_N > 0.0) ||
      !(params.range_Nm > 0.0))
    throw std::invalid_argument("sensor model: accepted noise >= 0 and range > 0");
}

// Returns a standard normal random number. It uses the Box-Muller method so that readings do not depend on
// the standard library's implementation of std::normal_distribution.
double SensorModel::Normal() noexcept {
  const double u = (static_cast<double>(random_()) + 1.0) / 4294967297.0;
  const double v = static_cast<double>(random_()) / 4294967296.0;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

SensorModel::Sample SensorModel::Read(rt::Nanoseconds now, const Wrench& load) noexcept {
  if (start_ < 0) start_ = now;
  const double t = rt::ToSeconds(now - start_);
  const Vector3 f = load.f + Vector3(params_.bias.f) + t * Vector3(params_.drift_N_per_s);
  const Vector3 m = load.t + Vector3(params_.bias.t) + t * Vector3(params_.drift_Nm_per_s);
  Sample sample;
  for (int axis = 0; axis < 6; ++axis) {
    const bool force = axis < 3;
    const double range = force ? params_.range_N : params_.range_Nm;
    const double noise = force ? params_.noise_N : params_.noise_Nm;
    const double value = (force ? f[axis] : m[axis - 3]) + (noise > 0.0 ? noise * Normal() : 0.0);
    const double reading = std::clamp(std::isfinite(value) ? value : 0.0, -range, range);
    if (std::abs(reading) >= range) sample.saturated |= 1u << axis;
    sample.value[static_cast<std::size_t>(axis)] = reading;
  }
  return sample;
}

}  // namespace osteon::hil
