#pragma once

#include "control/rt/clock.h"
#include "hil/plc/panel.h"

namespace osteon::hil {

/// The person at the buttons of a simulated run: automatic mode, the enabling switch in its middle position,
/// the pedal pressed, and the reset button pressed again and again until motion is permitted for the first
/// time. A stop after that is left as it is: it takes a person's decision to go on.
class PanelOperator {
 public:
  /// @param now  on any clock, never less than before
  [[nodiscard]] PlcPanel Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs);

 private:
  bool permitted_once_{false};
};

}  // namespace osteon::hil
