#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "control/rt/clock.h"

// What a scenario does to the wires between devices and controller, as plain data.

namespace osteon::hil {

/// What becomes of the datagrams (or frames) that go one way over one wire; by default nothing. Shares are of
/// the datagrams, 0 … 1.
struct WireFaults {
  double loss{0.0};           ///< never arrive
  int burst{1};               ///< lost in a row each time that one is lost; `loss` stays their share
  double duplicate{0.0};      ///< arrive twice
  double reorder{0.0};        ///< let the next one pass, which is not held back itself
  double corrupt{0.0};        ///< bits of one byte are others, or the end is missing
  rt::Nanoseconds delay{0};   ///< of each
  rt::Nanoseconds jitter{0};  ///< on top, from 0 to this, all equally likely; the order stays
  bool silence{false};        ///< nothing is taken; what is on its way arrives

  friend bool operator==(const WireFaults&, const WireFaults&) = default;
};

enum class Wire : std::uint8_t { kArm, kForceSensor, kDrive, kPlc };
enum class Direction : std::uint8_t { kToController, kFromController, kBoth };

/// Faults of one wire for some time.
///
/// **Time** counts in seconds from when COMMANDING_ACTIVE first began, and goes on where it ends. Before that
/// nothing is injected, unless `from_s` is below zero: such faults are there from the very start.
struct Injection {
  Wire wire{Wire::kArm};
  Direction direction{Direction::kBoth};
  double from_s{0.0};
  double to_s{std::numeric_limits<double>::infinity()};  ///< > from_s; this moment is no longer in it
  WireFaults faults{};
};

/// All of a run. Where several of one wire and direction overlap they add up: shares (to 1 at most), delays
/// and jitters; the longest burst counts.
struct InjectionParams {
  std::vector<Injection> injections{};
  std::uint64_t seed{1};
};

/// @throws std::invalid_argument naming the injection's place in the list, the field, the value found and
/// what is accepted.
void Validate(const InjectionParams& params);

}  // namespace osteon::hil
