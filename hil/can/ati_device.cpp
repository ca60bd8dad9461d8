#include "hil/can/ati_device.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace osteon::hil {
namespace {

constexpr double kFullScale_counts = 30000.0;  // value of gauge i for a load at the range of axis i

// Returns the value's four bytes, the highest first; for a float, the bytes of its bit pattern.
std::array<int, 4> BigEndian(std::uint32_t value) {
  return {static_cast<int>(value / 16777216), static_cast<int>(value / 65536 % 256),
          static_cast<int>(value / 256 % 256), static_cast<int>(value % 256)};
}

std::array<int, 4> BigEndian(float value) {
  std::uint32_t bits = 0;
  static_assert(sizeof bits == sizeof value);
  std::memcpy(&bits, &value, sizeof bits);
  return BigEndian(bits);
}

// Returns a gauge value in the format in which it is sent: an i16, clamped to the type's range, high byte
// first.
std::array<int, 2> TwoBytes(double gauge) {
  const int raw = static_cast<int>(std::lround(std::clamp(gauge, -32768.0, 32767.0)));
  const int on_the_wire = raw < 0 ? raw + 65536 : raw;
  return {on_the_wire / 256, on_the_wire % 256};
}

// Removes the axes' ranges: this sensor's gauges saturate, not its axes, so the model must not clamp the
// load.
SensorModelParams WithoutClamp(SensorModelParams params) {
  params.range_N = params.range_Nm = 1e9;
  return params;
}

}  // namespace

AtiDevice::AtiDevice(const AtiDeviceParams& params) : params_(params), model_(WithoutClamp(params.model)) {
  if (params.base < 0 || params.base > 0x7F)
    throw std::invalid_argument("ATI sensor: base: found " + std::to_string(params.base) +
                                ", accepted 0 … 127");
  if (params.counts_per_N == 0 || params.counts_per_Nm == 0)
    throw std::invalid_argument("ATI sensor: counts a unit: accepted more than 0");
  // The calibration matrix is diagonally dominant, so it can be inverted, and almost full, so that each gauge
  // affects several axes. Its elements are rounded to float, the format in which they are sent.
  for (int row = 0; row < 6; ++row) {
    const double range =
        row < 3 ? params.model.range_N * params.counts_per_N : params.model.range_Nm * params.counts_per_Nm;
    for (int column = 0; column < 6; ++column) {
      const double share = row == column ? 1.0 : 0.02 * ((row + 2 * column) % 5 - 2);
      matrix_(row, column) = static_cast<float>(range / kFullScale_counts * share);
    }
  }
  inverse_ = matrix_.inverse();
}

void AtiDevice::SetSilent(bool silent) {
  silent_ = silent;
  queue_.Clear();
}

void AtiDevice::Accept(const io::CanArrival& arrival) OSTEON_RT {
  const io::CanFrame& frame = arrival.frame;
  if (silent_ || frame.id / 16 != params_.base) return;
  const auto answer_id = [this](int code) { return static_cast<std::uint16_t>(16 * params_.base + code); };
  switch (frame.id % 16) {
    case 0:  // read the gauges
      if (frame.size == 0) QueueReading(arrival.stamp);
      return;
    case 2: {  // read a row of the matrix, in three frames of two floats
      if (frame.size != 1 || frame.data[0] > 5) return;
      const int row = frame.data[0];
      for (int part = 0; part < 3; ++part) {
        const auto a = BigEndian(static_cast<float>(matrix_(row, 2 * part)));
        const auto b = BigEndian(static_cast<float>(matrix_(row, 2 * part + 1)));
        queue_.Push(answer_id(2 + part), {a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]});
      }
      return;
    }
    case 7: {  // read the counts per N and per N·m
      const auto a = BigEndian(params_.counts_per_N), b = BigEndian(params_.counts_per_Nm);
      queue_.Push(answer_id(7), {a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]});
      return;
    }
    case 8:  // read the unit codes
      queue_.Push(answer_id(8), {params_.force_unit, params_.torque_unit});
      return;
    default:
      return;
  }
}

void AtiDevice::QueueReading(rt::Nanoseconds now) noexcept {
  const SensorModel::Sample sample = model_.Read(now, load_);
  Eigen::Matrix<double, 6, 1> counts;
  for (int i = 0; i < 6; ++i)
    counts[i] =
        sample.value[static_cast<std::size_t>(i)] * (i < 3 ? params_.counts_per_N : params_.counts_per_Nm);
  const Eigen::Matrix<double, 6, 1> gauges = inverse_ * counts;
  // first frame: status and gauges 0, 2, 4; second frame: gauges 1, 3, 5
  const auto g = [&gauges](int i) { return TwoBytes(gauges[i]); };
  const int status = status_ == 0 ? 0 : status_ | 0x8000;  // bit 15: any error
  const auto first = static_cast<std::uint16_t>(16 * params_.base);
  queue_.Push(first, {status / 256, status % 256, g(0)[0], g(0)[1], g(2)[0], g(2)[1], g(4)[0], g(4)[1]});
  queue_.Push(static_cast<std::uint16_t>(first + 1), {g(1)[0], g(1)[1], g(3)[0], g(3)[1], g(5)[0], g(5)[1]});
}

bool AtiDevice::Next(rt::Nanoseconds /*now*/, io::CanFrame& frame) OSTEON_RT {
  return !silent_ && queue_.Pop(frame);
}

}  // namespace osteon::hil
