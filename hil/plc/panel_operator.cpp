#include "hil/plc/panel_operator.h"

namespace osteon::hil {
namespace {

// Duration of a press of the reset button, and of the pause before the next one.
constexpr rt::Nanoseconds kPress = 100 * rt::kMillisecond;

}  // namespace

PlcPanel PanelOperator::Step(rt::Nanoseconds now, const PlcLogicOutputs& outputs, std::uint64_t connections) {
  if (outputs.run_permitted) {
    permitted_once_ = true;
    connections_ = connections;
  }
  // whether the person presses the reset button: until the first permission, and after a controller or guard
  // has connected again
  const bool goes_on = !permitted_once_ || connections > connections_;
  return {.enabling = EnablingSwitch::kMiddle,
          .foot_pedal = true,
          .mode = ModeSelector::kAutomatic,
          .reset = goes_on && (now / kPress) % 2 == 1};
}

}  // namespace osteon::hil
