#pragma once

#include "base/clock.h"
#include "hil/plc/panel.h"

namespace osteon::hil {

/// The person at the controls of a simulated run: automatic mode, the enabling switch in its middle position,
/// the pedal pressed, and the reset button pressed repeatedly until motion is permitted for the first time. A
/// later stop is not reset: a person must decide to go on.
class PanelOperator {
 public:
  /// @param now  on any clock, never decreases
  [[nodiscard]] PlcPanel Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs);

 private:
  bool permitted_once_{false};
};

}  // namespace osteon::hil
