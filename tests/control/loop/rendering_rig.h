#pragma once

#include "control/loop/haptic_rendering.h"
#include "control/loop/motion_checks.h"
#include "tests/control/loop/start_rig.h"

namespace osteon::control {

/// The parts of a loop for the tests of rendering: those of StartRig, and in addition the parts that check
/// and render.
struct RenderingRig : StartRig {
  explicit RenderingRig(const ServoParams& p = ServoBench::Params()) : StartRig(p) {}

  [[nodiscard]] TickInputs Inputs() const {
    return {.state = state, .readings = readings, .model = model, .now = now};
  }

  /// Runs ticks of a standing arm until rendering begins, at most three. @returns whether rendering has begun
  bool StartRendering() {
    for (int i = 0; i < 3; ++i) {
      if (!Tick()) continue;
      rendering.Start(Inputs());
      return true;
    }
    return false;
  }

  ServoStatistics statistics;
  TickResult result;
  MotionChecks motion_checks{{.params = params,
                              .supervisor = supervisor,
                              .session = session,
                              .tool = tool,
                              .hand = hand,
                              .checks = checks,
                              .actions = actions,
                              .statistics = statistics,
                              .result = result}};
  HapticRendering rendering{{.params = params,
                             .supervisor = supervisor,
                             .session = session,
                             .tool = tool,
                             .hand = hand,
                             .coupling = coupling,
                             .checks = checks,
                             .impedance = impedance,
                             .actions = actions,
                             .motion_checks = motion_checks,
                             .statistics = statistics,
                             .result = result}};
};

}  // namespace osteon::control
