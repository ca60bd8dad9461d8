#include "config/reading/check_loop.h"

#include <stdexcept>

namespace osteon::config {

void CheckLoop(const Reader& cell, const control::ServoParams& servo) {
  try {
    control::Validate(servo);
    static_cast<void>(control::LawOf(servo));
  } catch (const std::invalid_argument& error) {
    cell.Refuse(servo.law == control::Law::kImpedance ? "impedance" : "admittance", error.what());
  }
}

}  // namespace osteon::config
