#include "hil/plc/panel_operator.h"

namespace osteon::hil {
namespace {

// Duration of a press of the reset button, and of the pause before the next one.
constexpr rt::Nanoseconds kPress = 100 * rt::kMillisecond;

}  // namespace

PlcPanel PanelOperator::Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs) {
  permitted_once_ |= outputs.run_permitted;
  return {.enabling = EnablingSwitch::kMiddle,
          .foot_pedal = true,
          .mode = ModeSelector::kAutomatic,
          .reset = !permitted_once_ && (now / kPress) % 2 == 1};
}

}  // namespace osteon::hil
