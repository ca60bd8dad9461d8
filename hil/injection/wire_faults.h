#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/clock.h"

// Faults that a scenario puts on the wires between devices and controller, as plain data.

namespace osteon::hil {

/// Faults of the datagrams (or frames) in one direction of one wire; none by default. Shares refer to the
/// number of datagrams, 0 … 1.
struct WireFaults {
  double loss{0.0};  ///< share that never arrives
  int burst{1};      ///< number of consecutive datagrams lost at a time; `loss` is still the overall share
  double duplicate{0.0};  ///< share that arrives twice
  /// Share that changes places with the next datagram; the next datagram is not delayed by that.
  double reorder{0.0};
  double corrupt{0.0};       ///< share in which bits of one byte change or the end is missing
  rt::Nanoseconds delay{0};  ///< delay of each datagram
  /// Random addition to the delay, uniform from 0 to this; the order does not change.
  rt::Nanoseconds jitter{0};
  bool silence{false};  ///< nothing is accepted; datagrams in transit still arrive

  friend bool operator==(const WireFaults&, const WireFaults&) = default;
};

enum class Wire : std::uint8_t { kArm, kForceSensor, kDrive, kPlc };
enum class Direction : std::uint8_t { kToController, kFromController, kBoth };

/// Faults of one wire for some time.
///
/// **Time** is in seconds since the first COMMANDING_ACTIVE, and continues after COMMANDING_ACTIVE ends.
/// Before the first COMMANDING_ACTIVE only injections with `from_s` < 0 are active; they are active from the
/// start of the run.
struct Injection {
  Wire wire{Wire::kArm};
  Direction direction{Direction::kBoth};
  double from_s{0.0};
  double to_s{std::numeric_limits<double>::infinity()};  ///< > from_s; exclusive
  WireFaults faults{};
};

/// All injections of a run. Overlapping injections of one wire and direction add up: shares (to 1 at most),
/// delays and jitters. For the burst, the longest one applies.
struct InjectionParams {
  std::vector<Injection> injections{};
  std::uint64_t seed{1};
};

/// @throws std::invalid_argument naming the injection's place in the list, the field, the value found and
/// what is accepted.
void Validate(const InjectionParams& params);

}  // namespace osteon::hil
