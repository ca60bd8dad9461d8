#pragma once

#include "kinematics/spatial.h"
#include "simulation/surface/surface_chunk.h"

namespace osteon::surface {

// Conversion between SI units in double precision and this folder's float millimetres.

[[nodiscard]] inline Vec3 ToMillimetres(const Vector3& p_m) {
  const Vector3 p_mm = 1e3 * p_m;
  return {static_cast<float>(p_mm.x()), static_cast<float>(p_mm.y()), static_cast<float>(p_mm.z())};
}

[[nodiscard]] inline Vector3 ToMetres(Vec3 p_mm) {
  return 1e-3 *
         Vector3(static_cast<double>(p_mm.x), static_cast<double>(p_mm.y), static_cast<double>(p_mm.z));
}

}  // namespace osteon::surface
