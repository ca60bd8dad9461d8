#pragma once

#include "control/ports.h"

namespace osteon::io {

/// A session's state as FRI names it, "COMMANDING_ACTIVE"; "unknown" for a number that is none of them.
[[nodiscard]] constexpr const char* FriName(control::SessionState state) {
  switch (state) {
    case control::SessionState::kIdle:
      return "IDLE";
    case control::SessionState::kMonitoringWait:
      return "MONITORING_WAIT";
    case control::SessionState::kMonitoringReady:
      return "MONITORING_READY";
    case control::SessionState::kCommandingWait:
      return "COMMANDING_WAIT";
    case control::SessionState::kCommandingActive:
      return "COMMANDING_ACTIVE";
  }
  return "unknown";
}

}  // namespace osteon::io
