#pragma once

#include <cstdint>

#include "base/latest_value.h"
#include "base/marker.h"
#include "control/laws/gain_ramp.h"
#include "control/tick_record.h"

namespace osteon::control {

/// Gains that another thread requests, and the ramp on which the ticks reach them.
class GainRequests {
 public:
  /// @param gains  gains at the beginning; no request may exceed their coupling stiffness
  GainRequests(const Gains& gains, double period_s);

  /// Requests other gains. A later request replaces one that no tick has taken yet. From one thread, not the
  /// tick's.
  /// @throws std::invalid_argument naming the field, the value and what is accepted.
  void Request(const Gains& gains);

  /// Takes a request made since the last tick into the tick's input and as the ramp's new target, then
  /// advances the ramp by one tick.
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
  std::uint64_t requests_{0};     ///< made so far; belongs to the requesting thread
  std::uint64_t taken_{0};        ///< last request that a tick has taken
  double max_stiffness_N_per_m_;  ///< largest coupling stiffness that may be requested
  GainRamp ramp_;
};

}  // namespace osteon::control
