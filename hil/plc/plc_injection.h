#pragma once

#include <cstdint>

#include "hil/injection/fault_schedule.h"
#include "hil/plc/plc_server.h"

namespace osteon::hil {

/// A scenario's faults on the PLC's wire. Modbus runs over TCP, which loses no datagrams, so only these
/// faults have a meaning:
///
///     silence         the server hangs as long as it lasts
///     loss            connections are dropped when it begins, whatever its share
///     delay, jitter   answers come later by this time
///
/// The direction has no effect. One thread at a time.
class PlcInjection {
 public:
  /// @throws std::invalid_argument from Validate(params), and on a fault without a meaning here.
  PlcInjection(PlcServer& server, const InjectionParams& params);

  /// Starts the schedule at `now`, when COMMANDING_ACTIVE is seen; later calls change nothing.
  void StartSchedule(rt::Nanoseconds now) { schedule_.StartSchedule(now); }

  /// Applies the scenario's faults of `now`, on CLOCK_MONOTONIC. Call it as often as its times must be
  /// accurate.
  void Step(rt::Nanoseconds now);

  [[nodiscard]] std::uint64_t hangs() const { return hangs_; }  ///< silences begun
  [[nodiscard]] std::uint64_t drops() const { return drops_; }  ///< times that connections were dropped

 private:
  PlcServer& server_;
  FaultSchedule schedule_;
  std::uint64_t draws_;  // state of the random numbers for jitter
  WireFaults before_;    // of the step before
  std::uint64_t hangs_{0}, drops_{0};
};

}  // namespace osteon::hil
