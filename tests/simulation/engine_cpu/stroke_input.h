#pragma once

#include "simulation/engine/cutting_engine.h"
#include "tests/gpu/engine/contract_bench.h"
#include "tests/gpu/engine/strip_bench.h"

namespace osteon::simulation {

/// Input of frame `i` of gpu::Stroke: a rotating tool moves over a strip of balls with its spindle on.
inline FrameInput StrokeInput(int i) {
  return {.X_WT = gpu::Stroke(i), .spindle_rad_per_s = gpu::kSpindle_rad_per_s, .dt_s = 1e-3};
}

}  // namespace osteon::simulation
