#pragma once

#include "hil/plc/plc_logic.h"

namespace osteon::hil {

/// The operator's controls.
struct PlcPanel {
  bool emergency_stop{false};
  EnablingSwitch enabling{EnablingSwitch::kReleased};
  bool foot_pedal{false};
  ModeSelector mode{ModeSelector::kNone};
  bool reset{false};
  bool brake_test_due{false};
};

}  // namespace osteon::hil
