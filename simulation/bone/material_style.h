#pragma once

#include <array>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::simulation {

/// How a material is drawn.
struct MaterialStyle {
  const char* tint;             ///< "#rrggbb" in drawings, pale
  std::array<double, 3> color;  ///< sRGB 0 … 1 in shaded pictures
};

/// The style goes by a material's name: cartilage is bluish, cortical bone ivory, cancellous bone
/// reddish-yellow, …; a material of another name has a style by its index.
[[nodiscard]] const MaterialStyle& StyleOf(const std::vector<Material>& materials, MaterialIndex material);

}  // namespace osteon::simulation
