#pragma once

#include <cstdint>

#include "base/clock.h"
#include "hil/plc/panel.h"

namespace osteon::hil {

/// The person at the controls of a simulated run. This person selects automatic mode, holds the enabling
/// switch in its middle position and the pedal pressed, and presses the reset button repeatedly until motion
/// is permitted for the first time. A later stop is normally not reset, because a person must decide to
/// continue. The exception is a restart of the controller or of the guard, which is such a decision: if there
/// is a new connection to the PLC since motion was last permitted, the button is pressed again.
class PanelOperator {
 public:
  /// @param now  time on any clock; must not decrease
  /// @param connections  number of connections to the PLC so far
  [[nodiscard]] PlcPanel Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs, std::uint64_t connections);

 private:
  bool permitted_once_{false};
  std::uint64_t connections_{0};  // number of connections when motion was last permitted
};

}  // namespace osteon::hil
