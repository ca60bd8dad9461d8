#include "hil/can/robotous_device.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteon::hil {
namespace {

// Rates and low-pass corners, indexed by their codes in commands.
constexpr std::array<int, 9> kRateHz{200, 10, 20, 50, 100, 200, 300, 500, 1000};
constexpr std::array<int, 15> kCutoffHz{0, 1, 2, 3, 5, 10, 20, 30, 40, 50, 100, 150, 200, 300, 500};
constexpr int kErrorUnsupported = 1, kErrorRange = 2;
// if the next reading is overdue by more than this, the schedule restarts
constexpr rt::Nanoseconds kCatchUp = 50 * rt::kMillisecond;

}  // namespace

RobotousDevice::RobotousDevice(const RobotousDeviceParams& params) : params_(params), model_(params.model) {}

void RobotousDevice::SetFaults(const RobotousDeviceFaults& faults) {
  if (faults.silent && !faults_.silent) {
    sending_ = false;
    rate_code_ = filter_on_ = filter_code_ = 0;
    zero_ = {};
    queue_.Clear();
  }
  faults_ = faults;
}

// Queues a reply of 16 bytes: the echoed command, a and b; the remaining bytes are 0.
void RobotousDevice::Reply(int echo, int a, int b) noexcept {
  queue_.Push(static_cast<std::uint16_t>(params_.first_id), {echo, a, b, 0, 0, 0, 0, 0});
  queue_.Push(static_cast<std::uint16_t>(params_.second_id), {0, 0, 0, 0, 0, 0, 0, 0});
}

void RobotousDevice::Accept(const io::CanArrival& arrival) OSTEON_RT {
  const io::CanFrame& frame = arrival.frame;
  if (faults_.silent || frame.id != params_.command_id || frame.size != 8) return;
  const int code = frame.data[0], a = frame.data[1], b = frame.data[2];
  if (sending_ && code != 0x0C && code != 0x11) return;
  if (code == faults_.refuse_code && code != 0) return Reply(code, 0, kErrorUnsupported);
  switch (code) {
    case 0x08:  // set the filter
      if (a > 1 || b >= static_cast<int>(kCutoffHz.size())) return Reply(code, 0, kErrorRange);
      filter_on_ = a;
      filter_code_ = b;
      return Reply(code, 1);
    case 0x09:  // read the filter
      return Reply(code, filter_on_, filter_code_);
    case 0x0A:  // read once
      return QueueReading(code, arrival.stamp);
    case 0x0B:  // start
      sending_ = true;
      low_pass_fresh_ = true;
      due_ = arrival.stamp;
      return;
    case 0x0C:  // stop
      sending_ = false;
      return;
    case 0x0F:  // set the rate
      if (a >= static_cast<int>(kRateHz.size())) return Reply(code, 0, kErrorRange);
      if (!faults_.keeps_its_rate) rate_code_ = a;
      return Reply(code, 1);
    case 0x10:  // read the rate
      return Reply(code, rate_code_);
    case 0x11:  // bias: 1 takes the next reading, 0 clears it
      if (a == 1) take_bias_ = true;
      if (a == 0) zero_ = {};
      return;
    case 0x12:  // overload counts
      queue_.Push(static_cast<std::uint16_t>(params_.first_id),
                  {code, overloads_[0], overloads_[1], overloads_[2], overloads_[3], overloads_[4],
                   overloads_[5], 0});
      queue_.Push(static_cast<std::uint16_t>(params_.second_id), {0, 0, 0, 0, 0, 0, 0, 0});
      return;
    default:
      return Reply(code, 0, kErrorUnsupported);
  }
}

bool RobotousDevice::Next(rt::Nanoseconds now, io::CanFrame& frame) OSTEON_RT {
  if (faults_.silent) return false;
  if (queue_.Pop(frame)) return true;
  if (!sending_ || now < due_) return false;
  const int hz = kRateHz[static_cast<std::size_t>(faults_.lies_about_rate ? 0 : rate_code_)];
  if (now - due_ > kCatchUp) due_ = now;
  due_ += rt::kSecond / hz;
  QueueReading(0x0B, now);
  return queue_.Pop(frame);
}

void RobotousDevice::QueueReading(int echo, rt::Nanoseconds now) noexcept {
  const SensorModel::Sample sample = model_.Read(now, load_);
  Values value = sample.value;
  if (filter_on_ == 1 && filter_code_ > 0 && !low_pass_fresh_) {
    const int hz = kRateHz[static_cast<std::size_t>(rate_code_)];
    // first-order low-pass filter
    const double share =
        1.0 - std::exp(-2.0 * std::numbers::pi * kCutoffHz[static_cast<std::size_t>(filter_code_)] / hz);
    for (std::size_t i = 0; i < 6; ++i) value[i] = low_passed_[i] + share * (value[i] - low_passed_[i]);
  }
  low_passed_ = value;
  low_pass_fresh_ = false;
  if (take_bias_) zero_ = value;
  take_bias_ = false;

  std::array<int, 12> bytes{};
  for (std::size_t i = 0; i < 6; ++i) {
    const double counts = (value[i] - zero_[i]) * (i < 3 ? params_.counts_per_N : params_.counts_per_Nm);
    const int raw = static_cast<int>(std::lround(std::clamp(counts, -32768.0, 32767.0)));
    const int on_the_wire = raw < 0 ? raw + 65536 : raw;  // two's complement, high byte first
    bytes[2 * i] = on_the_wire / 256;
    bytes[2 * i + 1] = on_the_wire % 256;
    if ((sample.saturated >> i & 1u) != 0) overloads_[i] = std::min(overloads_[i] + 1, 255);
  }
  const auto& v = bytes;
  queue_.Push(static_cast<std::uint16_t>(params_.first_id), {echo, v[0], v[1], v[2], v[3], v[4], v[5], v[6]});
  queue_.Push(static_cast<std::uint16_t>(params_.second_id),
              {v[7], v[8], v[9], v[10], v[11], static_cast<int>(sample.saturated), 0, 0});
  ++readings_;
}

}  // namespace osteon::hil
