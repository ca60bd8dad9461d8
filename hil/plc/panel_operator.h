#pragma once

#include <cstdint>

#include "base/clock.h"
#include "hil/plc/panel.h"

namespace osteon::hil {

/// The person at the controls of a simulated run: automatic mode, the enabling switch in its middle position,
/// the pedal pressed, and the reset button pressed repeatedly until motion is permitted for the first time. A
/// later stop is not reset, because a person must decide to go on. Who starts the controller or the guard
/// again has decided it: the restart shows by a connection to the PLC that is made after motion was last
/// permitted, and the button is pressed again.
class PanelOperator {
 public:
  /// @param now  on any clock, never decreases
  /// @param connections  to the PLC so far
  [[nodiscard]] PlcPanel Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs, std::uint64_t connections);

 private:
  bool permitted_once_{false};
  std::uint64_t connections_{0};  // when motion was last permitted
};

}  // namespace osteon::hil
