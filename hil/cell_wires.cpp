#include "hil/cell_wires.h"

#include "hil/fri/fri_codec.h"

namespace osteon::hil {

CellWires::CellWires(const InjectionParams& params)
    : to_controller(params, Wire::kArm, Direction::kToController),
      from_controller(params, Wire::kArm, Direction::kFromController, {.bytes = kFriMaxDatagram + 1}) {}

void CellWires::StartSchedule(rt::Nanoseconds now) OSTEON_RT {
  to_controller.StartSchedule(now);
  from_controller.StartSchedule(now);
}

}  // namespace osteon::hil
