#pragma once

#include <cstdint>

#include "hil/injection/fault_schedule.h"
#include "hil/plc/plc_server.h"

namespace osteon::hil {

/// What a scenario does to the PLC's wire. Modbus runs over TCP, which knows no lost datagrams, so of the
/// faults these have a meaning:
///
///     silence         the server hangs as long as it lasts
///     loss            connections are dropped when it begins, whatever its share
///     delay, jitter   answers come so much later
///
/// The direction plays no part. One thread at a time.
class PlcInjection {
 public:
  /// @throws std::invalid_argument from Validate(params), and on a fault that has no meaning here.
  PlcInjection(PlcServer& server, const InjectionParams& params);

  /// COMMANDING_ACTIVE is seen at `now`; later calls change nothing.
  void Begin(rt::Nanoseconds now) { schedule_.Begin(now); }

  /// Orders what the scenario has for `now`, on CLOCK_MONOTONIC; to be called as often as its times shall be
  /// kept.
  void Step(rt::Nanoseconds now);

  [[nodiscard]] std::uint64_t hangs() const { return hangs_; }  ///< silences that have begun
  [[nodiscard]] std::uint64_t drops() const { return drops_; }  ///< times that connections were dropped

 private:
  PlcServer& server_;
  FaultSchedule schedule_;
  std::uint64_t draws_;
  WireFaults before_;
  std::uint64_t hangs_{0}, drops_{0};
};

}  // namespace osteon::hil
