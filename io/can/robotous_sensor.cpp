#include "io/can/robotous_sensor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/can/byte_order.h"

namespace osteon::io {
namespace {

// First byte of a command and of its answer.
enum Code : std::uint8_t {
  kSetFilter = 0x08,
  kReadFilter = 0x09,
  kStartOutput = 0x0B,
  kStopOutput = 0x0C,
  kSetRate = 0x0F,
  kReadRate = 0x10,
  kSetBias = 0x11,
};

// A rate or cut-off frequency [Hz], and the sensor's code for it.
struct Choice {
  int hz;
  std::uint8_t code;
};
// Code 6 is not offered: it means 300 or 333 Hz, depending on the source.
constexpr std::array<Choice, 7> kRates{{{10, 1}, {20, 2}, {50, 3}, {100, 4}, {200, 5}, {500, 7}, {1000, 8}}};
constexpr std::array<Choice, 15> kFilters{{{0, 0},
                                           {1, 1},
                                           {2, 2},
                                           {3, 3},
                                           {5, 4},
                                           {10, 5},
                                           {20, 6},
                                           {30, 7},
                                           {40, 8},
                                           {50, 9},
                                           {100, 10},
                                           {150, 11},
                                           {200, 12},
                                           {300, 13},
                                           {500, 14}}};

// Finds the choice with this frequency; null if the sensor does not offer it.
template <std::size_t N>
const Choice* FindChoice(const std::array<Choice, N>& choices, int hz) {
  const auto* const found =
      std::find_if(choices.begin(), choices.end(), [hz](const Choice& c) { return c.hz == hz; });
  return found == choices.end() ? nullptr : found;
}

// Lists the frequencies for an error text: "10, 20, …".
template <std::size_t N>
std::string AcceptedHz(const std::array<Choice, N>& choices) {
  std::string text;
  for (const Choice& choice : choices) text += fmt::format("{}{}", text.empty() ? "" : ", ", choice.hz);
  return text;
}

// Meaning of the error number in the answer to a set command.
const char* ErrorText(int code) {
  switch (code) {
    case 1:
      return "command not supported";
    case 2:
      return "value out of range";
    case 3:
      return "cannot write its memory";
    default:
      return "unknown";
  }
}

// Accepted range of the ratio of measured to nominal period. Outside this range the sensor sends at another
// rate, because the next lower rate has at least twice the period.
constexpr double kMaxPeriodRatio = 1.5, kMinPeriodRatio = 0.6;

}  // namespace

tl::expected<RobotousSensor, std::string> RobotousSensor::Make(const RobotousParams& params) {
  const auto refuse = [](const std::string& text) { return tl::unexpected("Robotous sensor: " + text); };
  for (const std::uint16_t id : {params.command_id, params.first_id, params.second_id})
    if (id > kCanMaxId) return refuse(fmt::format("id: found 0x{:X}, accepted 0 … 0x7FF", id));
  if (params.command_id == params.first_id || params.command_id == params.second_id ||
      params.first_id == params.second_id)
    return refuse(fmt::format(
        "ids: found command 0x{:03X}, answers 0x{:03X} and 0x{:03X}; accepted: three different ones",
        params.command_id, params.first_id, params.second_id));
  if (FindChoice(kRates, params.rate_hz) == nullptr)
    return refuse(fmt::format("rate_hz: found {}, accepted {}", params.rate_hz, AcceptedHz(kRates)));
  if (FindChoice(kFilters, params.filter_hz) == nullptr)
    return refuse(
        fmt::format("filter_hz: found {}, accepted {} (0: off)", params.filter_hz, AcceptedHz(kFilters)));
  if (!(params.counts_per_N > 0.0) || !(params.counts_per_Nm > 0.0) || !std::isfinite(params.counts_per_N) ||
      !std::isfinite(params.counts_per_Nm))
    return refuse(fmt::format("counts: found {} a N and {} a N·m, accepted: more than 0", params.counts_per_N,
                              params.counts_per_Nm));
  if (params.answer_timeout <= 0 || params.settle < 0 || params.attempts < 1 || params.rate_readings < 2)
    return refuse(
        fmt::format("found answer_timeout {} ns, settle {} ns, attempts {}, rate_readings {}; accepted: "
                    "answer_timeout and "
                    "attempts more than 0, settle at least 0, rate_readings at least 2",
                    params.answer_timeout, params.settle, params.attempts, params.rate_readings));
  return RobotousSensor(params);
}

RobotousSensor::RobotousSensor(const RobotousParams& params)
    : params_(params),
      rate_code_(FindChoice(kRates, params.rate_hz)->code),
      filter_code_(FindChoice(kFilters, params.filter_hz)->code),
      joiner_({.first_id = params.first_id,
               .second_id = params.second_id,
               .window = rt::kSecond / (2 * params.rate_hz)}) {}

std::vector<CanFilter> Filters(const RobotousParams& params) {
  return {{.id = params.first_id}, {.id = params.second_id}};
}

void RobotousSensor::Accept(const CanArrival& arrival) OSTEON_RT {
  if (joiner_.Add(arrival) != PairJoiner::Result::kJoined || phase_ == SensorPhase::kFailed) return;
  const auto& bytes = joiner_.bytes();
  if (bytes[0] == kStartOutput && step_ >= Step::kStart) {
    if (step_ == Step::kStart && attempts_ == 0) return;  // "start" was not sent yet
    HandleReading(bytes, joiner_.stamp());
  } else {
    HandleAnswer(bytes);
  }
}

void RobotousSensor::HandleAnswer(const std::array<std::uint8_t, 16>& bytes) OSTEON_RT {
  // An answer is expected only after its command was sent. Readings that the sensor sent before "stop" still
  // arrive for some time; they count as unexpected.
  const Step step = attempts_ > 0 ? step_ : Step::kStop;
  if (step == Step::kSetFilter && bytes[0] == kSetFilter) {
    if (bytes[2] != 0) return Fail(Failure::kRefused, bytes[2]);
  } else if (step == Step::kReadFilter && bytes[0] == kReadFilter) {
    const bool off = filter_code_ == 0;
    if (bytes[1] != (off ? 0 : 1) || (!off && bytes[2] != filter_code_))
      return Fail(Failure::kFilter, bytes[2]);
  } else if (step == Step::kSetRate && bytes[0] == kSetRate) {
    if (bytes[2] != 0) return Fail(Failure::kRefused, bytes[2]);
  } else if (step == Step::kReadRate && bytes[0] == kReadRate) {
    if (bytes[1] != rate_code_) return Fail(Failure::kRateCode, bytes[1]);
  } else {
    ++unexpected_;
    return;
  }
  Advance();
}

void RobotousSensor::HandleReading(const std::array<std::uint8_t, 16>& bytes,
                                   rt::Nanoseconds stamp) OSTEON_RT {
  if (step_ == Step::kStart) {
    Advance();
    rate_since_ = rate_last_ = stamp;
    rate_count_ = 0;
  } else if (step_ == Step::kMeasureRate) {
    MeasureRate(stamp);
  }
  if (step_ != Step::kRunning) return;

  // converts an axis' counts to force [N] or torque [N·m]
  const auto value = [&](std::size_t axis, double counts) {
    return GetBig<std::int16_t>(bytes.data() + 1 + 2 * axis) / counts;
  };
  latest_.stamp = stamp;
  latest_.F_S = Wrench{
      .f = {value(0, params_.counts_per_N), value(1, params_.counts_per_N), value(2, params_.counts_per_N)},
      .t = {value(3, params_.counts_per_Nm), value(4, params_.counts_per_Nm),
            value(5, params_.counts_per_Nm)}};
  latest_.status = bytes[13];
  latest_.flags = (bytes[13] & 0x3F) != 0 ? kSensorOverload : 0u;
  ++readings_;
}

void RobotousSensor::MeasureRate(rt::Nanoseconds stamp) OSTEON_RT {
  rate_last_ = stamp;
  if (++rate_count_ < params_.rate_readings) return;
  const double period_s = rt::ToSeconds(stamp - rate_since_) / rate_count_;
  const double ratio = period_s * params_.rate_hz;
  if (ratio > kMaxPeriodRatio || ratio < kMinPeriodRatio) return Fail(Failure::kRateMeasured, 1.0 / period_s);
  Advance();
}

void RobotousSensor::Advance() OSTEON_RT {
  step_ = static_cast<Step>(static_cast<int>(step_) + 1);
  attempts_ = 0;
  due_ = 0;
  if (step_ == Step::kRunning) phase_ = SensorPhase::kReady;
}

void RobotousSensor::Fail(Failure wrong, double found) OSTEON_RT {
  wrong_ = wrong;
  wrong_step_ = step_;
  found_ = found;
  phase_ = SensorPhase::kFailed;
}

void RobotousSensor::Restart() OSTEON_RT {
  phase_ = SensorPhase::kStarting;
  step_ = Step::kStop;
  attempts_ = 0;
  due_ = 0;
  wrong_ = Failure::kNothing;
  joiner_.GiveUp();
}

bool RobotousSensor::Next(rt::Nanoseconds now, CanFrame& frame) OSTEON_RT {
  if (phase_ == SensorPhase::kFailed) return false;
  if (step_ == Step::kMeasureRate || step_ == Step::kRunning) {
    // The measurement of the rate fails if its readings do not arrive within twice their nominal time.
    if (step_ == Step::kMeasureRate) {
      const rt::Nanoseconds nominal = rt::kSecond / params_.rate_hz * params_.rate_readings;
      if (due_ == 0) due_ = now + 2 * nominal + params_.answer_timeout;
      if (now >= due_)
        Fail(Failure::kRateMeasured,
             rate_count_ > 0 ? rate_count_ / rt::ToSeconds(rate_last_ - rate_since_) : 0.0);
    }
    // while running, the only possible command is the bias
    if (bias_ == Bias::kNone || step_ != Step::kRunning) return false;
    frame = {.id = params_.command_id,
             .size = 8,
             .data = {kSetBias, bias_ == Bias::kSet ? std::uint8_t{1} : std::uint8_t{0}}};
    bias_ = Bias::kNone;
    return true;
  }
  if (attempts_ > 0 && now < due_) return false;
  if (step_ == Step::kStop && attempts_ > 0) Advance();  // the sensor does not answer "stop"
  if (attempts_ == params_.attempts) {
    Fail(Failure::kSilent, attempts_);
    return false;
  }
  ++attempts_;
  due_ = now + (step_ == Step::kStop ? params_.settle : params_.answer_timeout);
  frame = Command(step_);
  return true;
}

CanFrame RobotousSensor::Command(Step step) const OSTEON_RT {
  CanFrame frame{.id = params_.command_id, .size = 8};
  const auto set = [&frame](std::uint8_t code, std::uint8_t first = 0, std::uint8_t second = 0) {
    frame.data[0] = code;
    frame.data[1] = first;
    frame.data[2] = second;
  };
  switch (step) {
    case Step::kSetFilter:
      set(kSetFilter, filter_code_ == 0 ? 0 : 1, filter_code_);
      break;
    case Step::kReadFilter:
      set(kReadFilter);
      break;
    case Step::kSetRate:
      set(kSetRate, rate_code_);
      break;
    case Step::kReadRate:
      set(kReadRate);
      break;
    case Step::kStart:
      set(kStartOutput);
      break;
    default:
      set(kStopOutput);
  }
  return frame;
}

SensorCounters RobotousSensor::counters() const OSTEON_RT {
  return {.readings = readings_,
          .halves = joiner_.halves(),
          .malformed = joiner_.malformed(),
          .unexpected = unexpected_};
}

std::string RobotousSensor::failure() const {
  if (phase_ != SensorPhase::kFailed) return {};
  const std::string place = fmt::format(
      "Robotous sensor (command id 0x{:03X}, answers 0x{:03X} and 0x{:03X}): ", params_.command_id,
      params_.first_id, params_.second_id);
  const int command = Command(wrong_step_).data[0];
  switch (wrong_) {
    case Failure::kNothing:
      break;
    case Failure::kSilent:
      return place + fmt::format(
                         "no answer to command 0x{:02X} in {} attempts; check its supply, the wiring, "
                         "the bit rate (1 Mbit/s) and its ids",
                         command, static_cast<int>(found_));
    case Failure::kRefused:
      return place + fmt::format("refused command 0x{:02X} with error {} ({})", command,
                                 static_cast<int>(found_), ErrorText(static_cast<int>(found_)));
    case Failure::kFilter:
      return place + fmt::format("its low-pass reads back as code {}, accepted {} ({} Hz)",
                                 static_cast<int>(found_), filter_code_, params_.filter_hz);
    case Failure::kRateCode:
      return place + fmt::format("its rate reads back as code {}, accepted {} ({} Hz)",
                                 static_cast<int>(found_), rate_code_, params_.rate_hz);
    case Failure::kRateMeasured:
      return place + fmt::format("readings come at {:.0f} Hz, accepted {} Hz; it said it would", found_,
                                 params_.rate_hz);
  }
  return place + "failed";
}

}  // namespace osteon::io
