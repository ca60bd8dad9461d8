#include "hil/arm_controller.h"

namespace osteon::hil {

std::string DescribeStop(const ArmStatus& status) {
  if (status.rsi_stop.reason != RsiStopReason::kNone) return Describe(status.rsi_stop);
  return status.stop.reason == StopReason::kNone ? std::string() : Describe(status.stop);
}

}  // namespace osteon::hil
