#pragma once

#include "control/ports.h"

namespace osteon::io {

/// Returns FRI's name of a session state, e.g. "COMMANDING_ACTIVE"; "unknown" for an invalid number.
[[nodiscard]] constexpr const char* SessionName(control::SessionState state) {
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
