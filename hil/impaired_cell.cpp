#include "hil/impaired_cell.h"

#include <cmath>
#include <utility>

namespace osteon::hil {

ImpairedCell::ImpairedCell(SimulatedCell cell, const InjectionParams& injections)
    : cell_(std::move(cell)), wires_(injections), period_(std::llround(cell_.period_s() * 1e9)) {}

void ImpairedCell::StepCell(rt::Nanoseconds now) {
  while (wires_.from_controller.NextDue() <= now) cell_.Receive(wires_.from_controller.Next(now));
  const auto message = cell_.Step(now);
  if (cell_.state().active_once) wires_.StartSchedule(now);
  if (!message.empty()) wires_.to_controller.Push(message, now);
}

}  // namespace osteon::hil
