#pragma once

#include <array>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::simulation {

/// How a material is drawn.
struct MaterialStyle {
  const char* tint;             ///< pale colour in drawings, "#rrggbb"
  std::array<double, 3> color;  ///< colour in shaded pictures, sRGB 0 … 1
};

/// Returns a material's style, which depends on its name: cartilage is bluish, cortical bone ivory,
/// cancellous bone reddish-yellow, …; a material of another name has a style by its index.
[[nodiscard]] const MaterialStyle& StyleOf(const std::vector<Material>& materials, MaterialIndex material);

}  // namespace osteon::simulation
