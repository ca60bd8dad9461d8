#pragma once

#include "simulation/engine/cutting_engine.h"
#include "tests/gpu/engine/contract_bench.h"
#include "tests/gpu/engine/strip_bench.h"

namespace osteon::simulation {

/// Frame `i` of a turning tool that is drawn over a strip of balls.
inline FrameInput StrokeInput(int i) {
  return {.X_WT = gpu::Stroke(i), .spindle_rad_per_s = gpu::kSpindle_rad_per_s, .dt_s = 1e-3};
}

}  // namespace osteon::simulation
