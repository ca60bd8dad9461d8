#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/clock.h"

// Faults that a scenario puts on the wires between devices and controller, as plain data.

namespace osteon::hil {

/// Faults of the datagrams (or frames) in one direction of one wire; none by default. Shares are of the
/// datagrams, 0 … 1.
struct WireFaults {
  double loss{0.0};           ///< never arrive
  int burst{1};               ///< length of a loss in a row; `loss` stays the overall share
  double duplicate{0.0};      ///< arrive twice
  double reorder{0.0};        ///< swap places with the next datagram, which is not delayed
  double corrupt{0.0};        ///< bits of one byte change, or the end is missing
  rt::Nanoseconds delay{0};   ///< of each datagram
  rt::Nanoseconds jitter{0};  ///< added to the delay, uniform from 0 to this; the order stays
  bool silence{false};        ///< nothing is accepted; datagrams in transit still arrive

  friend bool operator==(const WireFaults&, const WireFaults&) = default;
};

enum class Wire : std::uint8_t { kArm, kForceSensor, kDrive, kPlc };
enum class Direction : std::uint8_t { kToController, kFromController, kBoth };

/// Faults of one wire for some time.
///
/// **Time** counts in seconds from the first COMMANDING_ACTIVE, and continues after its end. Before that
/// nothing is injected, except by injections whose `from_s` is below zero: they act from the very start.
struct Injection {
  Wire wire{Wire::kArm};
  Direction direction{Direction::kBoth};
  double from_s{0.0};
  double to_s{std::numeric_limits<double>::infinity()};  ///< > from_s; exclusive
  WireFaults faults{};
};

/// All injections of a run. Overlapping injections of one wire and direction add up: shares (to 1 at most),
/// delays and jitters; the longest burst counts.
struct InjectionParams {
  std::vector<Injection> injections{};
  std::uint64_t seed{1};
};

/// @throws std::invalid_argument naming the injection's place in the list, the field, the value found and
/// what is accepted.
void Validate(const InjectionParams& params);

}  // namespace osteon::hil
