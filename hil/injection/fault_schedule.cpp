#include "hil/injection/fault_schedule.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::hil {
namespace {

constexpr double kLongest_s = 1e9;  // longer than any run, and still within the range of nanoseconds
constexpr rt::Nanoseconds kLongestDelay = 10 * rt::kSecond;

// Converts seconds to nanoseconds; a very long or infinite time is limited to kLongest_s.
rt::Nanoseconds ToNanoseconds(double time_s) {
  return std::llround(std::clamp(time_s, -kLongest_s, kLongest_s) * 1e9);
}

// Adds two shares; the sum is at most 1.
double AddShares(double share, double other) OSTEON_RT { return std::min(1.0, share + other); }

}  // namespace

void Validate(const InjectionParams& params) {
  for (std::size_t i = 0; i < params.injections.size(); ++i) {
    const Injection& injection = params.injections[i];
    const auto require = [i](bool ok, const char* field, double found, const char* accepted) {
      if (ok) return;
      throw std::invalid_argument("injection " + std::to_string(i + 1) + ": " + field + ": found " +
                                  base::NumberText(found) + ", accepted " + accepted);
    };
    const auto share = [&require](const char* field, double found) {
      require(found >= 0.0 && found <= 1.0, field, found, "0 … 1");
    };
    const WireFaults& faults = injection.faults;
    share("loss", faults.loss);
    share("duplicate", faults.duplicate);
    share("reorder", faults.reorder);
    share("corrupt", faults.corrupt);
    require(faults.burst >= 1, "burst", faults.burst, ">= 1");
    require(faults.delay >= 0 && faults.delay <= kLongestDelay, "delay [s]", rt::ToSeconds(faults.delay),
            "0 … 10");
    require(faults.jitter >= 0 && faults.jitter <= kLongestDelay, "jitter [s]", rt::ToSeconds(faults.jitter),
            "0 … 10");
    require(std::isfinite(injection.from_s), "from_s", injection.from_s, "a finite time");
    require(injection.to_s > injection.from_s, "to_s", injection.to_s, "more than from_s");
  }
}

FaultSchedule::FaultSchedule(const InjectionParams& params, Wire wire, Direction direction) {
  Validate(params);
  for (const Injection& injection : params.injections) {
    if (injection.wire != wire) continue;
    const bool applies = injection.direction == direction || injection.direction == Direction::kBoth ||
                         direction == Direction::kBoth;
    if (!applies) continue;
    windows_.push_back({.from = ToNanoseconds(injection.from_s),
                        .to = ToNanoseconds(injection.to_s),
                        .faults = injection.faults});
  }
}

WireFaults FaultSchedule::At(rt::Nanoseconds now) const OSTEON_RT {
  WireFaults sum;
  const rt::Nanoseconds time = now - begun_at_;
  for (const Window& window : windows_) {
    // before the schedule starts, only windows whose beginning is negative are active
    if (begun_ ? time < window.from || time >= window.to : window.from >= 0) continue;
    const WireFaults& faults = window.faults;
    sum.loss = AddShares(sum.loss, faults.loss);
    sum.burst = std::max(sum.burst, faults.burst);
    sum.duplicate = AddShares(sum.duplicate, faults.duplicate);
    sum.reorder = AddShares(sum.reorder, faults.reorder);
    sum.corrupt = AddShares(sum.corrupt, faults.corrupt);
    sum.delay += faults.delay;
    sum.jitter += faults.jitter;
    sum.silence |= faults.silence;
  }
  return sum;
}

}  // namespace osteon::hil
