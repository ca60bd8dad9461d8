#include "hil/injection/cell_wires.h"

#include "hil/fri_codec.h"

namespace osteon::hil {

CellWires::CellWires(const InjectionParams& params)
    : to_controller(params, Wire::kArm, Direction::kToController),
      from_controller(params, Wire::kArm, Direction::kFromController, {.bytes = kFriMaxDatagram + 1}) {}

void CellWires::Begin(rt::Nanoseconds now) OSTEON_RT {
  to_controller.Begin(now);
  from_controller.Begin(now);
}

}  // namespace osteon::hil
