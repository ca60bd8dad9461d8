#pragma once

#include "simulation/solids/ball_solid.h"
#include "simulation/solids/box_solid.h"

namespace osteon::simulation {

/// A box centred at the origin.
inline BoxSolid CenteredBox(const Vector3& size_m) { return {-0.5 * size_m, 0.5 * size_m}; }

inline double Volume_m3(const BoxSolid& box) { return box.Bounds().volume(); }

}  // namespace osteon::simulation
