#pragma once

#include <cstdint>

#include "base/latest_value.h"
#include "base/marker.h"
#include "control/laws/gain_ramp.h"
#include "control/tick_record.h"

namespace osteon::control {

/// Receives gains that another thread requests, and moves the acting gains to them along a ramp.
class GainRequests {
 public:
  /// @param gains  gains at the beginning; their coupling stiffness is the largest one that may be requested
  GainRequests(const Gains& gains, double period_s);

  /// Requests other gains. If no tick has taken the previous request yet, the new one replaces it. Call from
  /// one thread only, not from the tick's.
  /// @throws std::invalid_argument naming the field, the value and what is accepted.
  void Request(const Gains& gains);

  /// If gains were requested since the last tick, stores them in the tick's input and makes them the ramp's
  /// target. Then advances the ramp by one tick.
  /// @param pressed  whether a plane is penetrated  @returns whether gains() have changed
  [[nodiscard]] bool Step(bool pressed, TickInput& input) OSTEON_RT;

  /// Gains of this tick.
  [[nodiscard]] const Gains& gains() const OSTEON_RT { return ramp_.now(); }

 private:
  struct Requested {
    std::uint64_t number{0};  ///< number of the request; 0: none
    Gains gains;
  };
  rt::LatestValue<Requested> requested_;
  std::uint64_t requests_{0};     ///< number of requests so far; used only by the requesting thread
  std::uint64_t taken_{0};        ///< number of the last request that a tick has taken
  double max_stiffness_N_per_m_;  ///< largest coupling stiffness that may be requested
  GainRamp ramp_;
};

}  // namespace osteon::control
