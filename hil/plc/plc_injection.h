#pragma once

#include <cstdint>

#include "hil/injection/fault_schedule.h"
#include "hil/plc/plc_server.h"

namespace osteon::hil {

/// Injects a scenario's faults into the PLC's connection. Modbus runs over TCP, which loses no datagrams, so
/// only these faults are possible:
///
///     silence         the server hangs while the silence lasts
///     loss            all connections are closed when the fault begins; its share has no effect
///     delay, jitter   answers are sent later by this time
///
/// The direction has no effect. One thread at a time.
class PlcInjection {
 public:
  /// @throws std::invalid_argument from Validate(params), and if a fault is configured that is not possible
  /// here.
  PlcInjection(PlcServer& server, const InjectionParams& params);

  /// Starts the schedule at `now`; call when COMMANDING_ACTIVE is first observed. Later calls change nothing.
  void StartSchedule(rt::Nanoseconds now) { schedule_.StartSchedule(now); }

  /// Applies the faults that are scheduled for `now`, a time of CLOCK_MONOTONIC. The interval between calls
  /// limits the accuracy of the faults' times.
  void Step(rt::Nanoseconds now);

  [[nodiscard]] std::uint64_t hangs() const { return hangs_; }  ///< number of silences begun
  /// Number of times that connections were closed.
  [[nodiscard]] std::uint64_t drops() const { return drops_; }

 private:
  PlcServer& server_;
  FaultSchedule schedule_;
  std::uint64_t draws_;  // state of the random generator for jitter
  WireFaults before_;    // faults of the previous step
  std::uint64_t hangs_{0}, drops_{0};
};

}  // namespace osteon::hil
