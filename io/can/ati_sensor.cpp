#include "io/can/ati_sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "io/can/byte_order.h"

namespace osteon::io {
namespace {

// Codes of messages: the low four bits of an identifier.
enum Code : std::uint16_t {
  kReadings = 0x0,
  kReadingsRest = 0x1,
  kMatrixRow = 0x2,
  kMatrixRowEnd = 0x4,
  kCounts = 0x7,
  kUnits = 0x8,
};
// values of step_; the values 0 … 5 request the matrix's rows
constexpr int kStepCounts = 6, kStepUnits = 7, kStepRunning = 8;

// Size of each unit in N or N·m, indexed by its code on the wire; code 0 is unused. Force: lbf, N, klbf, kN,
// kgf, gf. Torque: lbf·in, lbf·ft, N·m, N·mm, kgf·cm, kN·m.
constexpr double kPound_N = 4.4482216152605, kInch_m = 0.0254, kKilopond_N = 9.80665;
constexpr std::array<double, 7> kForceUnit_N{0.0,         kPound_N,          1.0, 1e3 * kPound_N, 1e3,
                                             kKilopond_N, 1e-3 * kKilopond_N};
constexpr std::array<double, 7> kTorqueUnit_Nm{
    0.0, kPound_N* kInch_m, kPound_N * 12 * kInch_m, 1.0, 1e-3, 0.01 * kKilopond_N, 1e3};

// Bits of the sensor's status word. kStatusFault: bits 1 … 8 (converter, ground, supply, calibration,
// memory), 11 and 12 (temperature).
constexpr std::uint16_t kStatusFault = 0x19FE;
constexpr std::uint16_t kStatusBus = 0x4000;  // a CAN error

// Identifier of a frame with `code`, for the sensor with `base`.
std::uint16_t Id(std::uint8_t base, std::uint16_t code) OSTEON_RT {
  return static_cast<std::uint16_t>(base << 4 | code);
}

// Decodes a float32 from four bytes, the highest first.
double DecodeFloat(const std::uint8_t* bytes) OSTEON_RT {
  return std::bit_cast<float>(GetBig<std::uint32_t>(bytes));
}

}  // namespace

tl::expected<AtiSensor, std::string> AtiSensor::Make(const AtiParams& params) {
  const auto refuse = [](const std::string& text) { return tl::unexpected("ATI sensor: " + text); };
  if (params.base > 0x7F) return refuse(fmt::format("base: found 0x{:X}, accepted 0 … 0x7F", params.base));
  if (params.period < 100'000)
    return refuse(fmt::format(
        "period: found {} ns, accepted: at least 100000 ns (three frames take that long)", params.period));
  if (params.answer_timeout <= 0 || params.attempts < 1 || params.bias_readings < 1)
    return refuse("answer_timeout, attempts and bias_readings must be positive");
  return AtiSensor(params);
}

AtiSensor::AtiSensor(const AtiParams& params)
    : params_(params),
      joiner_({.first_id = Id(params.base, kReadings),
               .second_id = Id(params.base, kReadingsRest),
               .second_size = 6,
               .window = params.period / 2}) {}

std::vector<CanFilter> Filters(const AtiParams& params) {
  return {{.id = Id(params.base, 0), .mask = 0x7F0}};
}

void AtiSensor::Accept(const CanArrival& arrival) OSTEON_RT {
  const CanFrame& frame = arrival.frame;
  if (frame.id >> 4 != params_.base || phase_ == SensorPhase::kFailed) return;
  const std::uint16_t code = frame.id & 0xF;
  if (step_ == kStepRunning) {
    if (code > kReadingsRest)
      ++unexpected_;
    else if (joiner_.Add(arrival) == PairJoiner::Result::kJoined)
      HandleReading();
    return;
  }
  if (arrival.after_gap) next_part_ = 0;
  if (attempts_ > 0 && step_ < kStepCounts && code >= kMatrixRow && code <= kMatrixRowEnd)
    HandleMatrix(frame, code - kMatrixRow);
  else if (attempts_ > 0 && step_ == kStepCounts && code == kCounts)
    HandleCounts(frame);
  else if (attempts_ > 0 && step_ == kStepUnits && code == kUnits)
    HandleUnits(frame);
  else
    ++unexpected_;
}

// A row of the matrix arrives in three parts. If they do not arrive in order, the whole row is requested
// again.
void AtiSensor::HandleMatrix(const CanFrame& frame, std::size_t part) OSTEON_RT {
  if (frame.size != 8) {
    ++malformed_;
    next_part_ = 0;
    return;
  }
  if (part != next_part_ && part != 0) {
    ++unexpected_;
    next_part_ = 0;
    return;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const double value = DecodeFloat(&frame.data[4 * i]);
    if (!std::isfinite(value)) return Fail(Wrong::kMatrix, step_, static_cast<double>(2 * part + i));
    matrix_[6 * static_cast<std::size_t>(step_) + 2 * part + i] = value;
  }
  next_part_ = part + 1;
  if (next_part_ == 3) Advance();
}

void AtiSensor::HandleCounts(const CanFrame& frame) OSTEON_RT {
  if (frame.size != 8) {
    ++malformed_;
    return;
  }
  counts_per_force_ = GetBig<std::uint32_t>(&frame.data[0]);
  counts_per_torque_ = GetBig<std::uint32_t>(&frame.data[4]);
  if (counts_per_force_ == 0.0 || counts_per_torque_ == 0.0)
    return Fail(Wrong::kCounts, counts_per_force_, counts_per_torque_);
  Advance();
}

void AtiSensor::HandleUnits(const CanFrame& frame) OSTEON_RT {
  if (frame.size != 2) {
    ++malformed_;
    return;
  }
  const std::uint8_t force = frame.data[0], torque = frame.data[1];
  if (force == 0 || force >= kForceUnit_N.size() || torque == 0 || torque >= kTorqueUnit_Nm.size())
    return Fail(Wrong::kUnits, force, torque);
  force_unit_N_ = kForceUnit_N[force];
  torque_unit_Nm_ = kTorqueUnit_Nm[torque];
  Advance();
}

void AtiSensor::HandleReading() OSTEON_RT {
  const auto& bytes = joiner_.bytes();
  Values gauges{}, wrench{};
  // order of the bytes: status, gauges 0, 2, 4, then gauges 1, 3, 5
  for (std::size_t i = 0; i < 6; ++i)
    gauges[i] = GetBig<std::int16_t>(&bytes[i % 2 == 0 ? 2 + i : 8 + (i - 1)]);
  const bool saturated =
      std::any_of(gauges.begin(), gauges.end(), [](double g) { return g >= 32767.0 || g <= -32768.0; });
  for (std::size_t row = 0; row < 6; ++row) {
    double counts = 0.0;
    for (std::size_t i = 0; i < 6; ++i) counts += matrix_[6 * row + i] * gauges[i];
    wrench[row] =
        row < 3 ? counts / counts_per_force_ * force_unit_N_ : counts / counts_per_torque_ * torque_unit_Nm_;
  }
  if (!std::all_of(wrench.begin(), wrench.end(), [](double x) { return std::isfinite(x); })) {
    ++unexpected_;
    return;
  }
  if (bias_left_ > 0) {  // a bias was requested: average this reading
    for (std::size_t i = 0; i < 6; ++i) bias_sum_[i] += wrench[i];
    if (--bias_left_ == 0)
      for (std::size_t i = 0; i < 6; ++i) bias_[i] = bias_sum_[i] / params_.bias_readings;
  }
  for (std::size_t i = 0; i < 6; ++i) wrench[i] -= bias_[i];

  const auto status = GetBig<std::uint16_t>(&bytes[0]);
  latest_.stamp = joiner_.stamp();
  latest_.F_S = Wrench{.f = {wrench[0], wrench[1], wrench[2]}, .t = {wrench[3], wrench[4], wrench[5]}};
  latest_.status = status;
  latest_.flags = saturated ? kSensorOverload : 0u;
  if ((status & kStatusFault) != 0) latest_.flags |= kSensorFault;
  if ((status & kStatusBus) != 0) latest_.flags |= kSensorBusError;
  if (status != 0 && (status & (kStatusFault | kStatusBus)) == 0) latest_.flags |= kSensorWarning;
  ++readings_;
}

void AtiSensor::RequestBias(bool on) OSTEON_RT {
  bias_sum_ = {};
  bias_left_ = on ? params_.bias_readings : 0;
  if (!on) bias_ = {};
}

void AtiSensor::Advance() OSTEON_RT {
  ++step_;
  next_part_ = 0;
  attempts_ = 0;
  due_ = 0;
  if (step_ == kStepRunning) phase_ = SensorPhase::kReady;
}

void AtiSensor::Fail(Wrong wrong, double found, double other) OSTEON_RT {
  wrong_ = wrong;
  found_ = found;
  found_other_ = other;
  phase_ = SensorPhase::kFailed;
}

void AtiSensor::Restart() OSTEON_RT {
  phase_ = SensorPhase::kStarting;
  step_ = 0;
  next_part_ = 0;
  attempts_ = 0;
  due_ = 0;
  wrong_ = Wrong::kNothing;
  joiner_.GiveUp();
}

bool AtiSensor::Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT {
  if (phase_ == SensorPhase::kFailed || now < due_) return false;
  frame = {.id = Id(params_.base, kReadings)};
  if (step_ == kStepRunning) {
    // drop the first half of an answer to an earlier request, so that it is not joined with a half of the
    // next answer
    joiner_.GiveUp();
    due_ = now - due_ > params_.period ? now + params_.period : due_ + params_.period;
    return true;
  }
  if (attempts_ == params_.attempts) {
    Fail(Wrong::kSilent, step_);
    return false;
  }
  ++attempts_;
  next_part_ = 0;
  due_ = now + params_.answer_timeout;
  if (step_ < kStepCounts)
    frame = {.id = Id(params_.base, kMatrixRow), .size = 1, .data = {static_cast<std::uint8_t>(step_)}};
  else
    frame.id = Id(params_.base, step_ == kStepCounts ? kCounts : kUnits);
  return true;
}

SensorCounters AtiSensor::counters() const OSTEON_RT {
  return {.readings = readings_,
          .halves = joiner_.halves(),
          .malformed = joiner_.malformed() + malformed_,
          .unexpected = unexpected_};
}

std::string AtiSensor::failure() const {
  if (phase_ != SensorPhase::kFailed) return {};
  const std::string place =
      fmt::format("ATI NETCANOEM sensor (base 0x{:02X}, ids 0x{:03X} … 0x{:03X}): ", params_.base,
                  Id(params_.base, 0), Id(params_.base, 0xF));
  // found_ is a step only for these causes; for others it may be a count that does not fit in an int
  const int step = wrong_ == Wrong::kSilent || wrong_ == Wrong::kMatrix ? static_cast<int>(found_) : 0;
  switch (wrong_) {
    case Wrong::kNothing:
      break;
    case Wrong::kSilent:
      return place + fmt::format(
                         "no answer about its {} in {} attempts; check its supply, the wiring, the bit rate "
                         "(1 Mbit/s) and its base",
                         step < kStepCounts    ? fmt::format("matrix row {}", step)
                         : step == kStepCounts ? "counts a unit"
                                               : "units",
                         params_.attempts);
    case Wrong::kMatrix:
      return place +
             fmt::format("its matrix is not finite in row {}, column {}; accepted: a calibrated sensor", step,
                         static_cast<int>(found_other_));
    case Wrong::kCounts:
      return place +
             fmt::format("its counts a unit are {} and {}, accepted: more than 0", found_, found_other_);
    case Wrong::kUnits:
      return place + fmt::format("its unit codes are {} (force) and {} (torque), accepted 1 … 6 each", found_,
                                 found_other_);
  }
  return place + "failed";
}

}  // namespace osteon::io
