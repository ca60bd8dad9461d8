#include "simulation/surface/surface_chunk.h"

#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::surface {
namespace {

/// Smallest number of air nodes between the box and the grid's border; the fields reach 3 voxels beyond a
/// surface.
constexpr float kMarginNodes = 6.0F;

}  // namespace

BrickLayout MakeLayout(Vec3 min_mm, Vec3 max_mm, float voxel_mm) {
  if (!(voxel_mm > 0.0F) || !std::isfinite(voxel_mm))
    throw std::invalid_argument("voxel: found " + base::NumberText(voxel_mm) + " mm, accepted above 0");
  const std::array<float, 3> low{min_mm.x, min_mm.y, min_mm.z}, high{max_mm.x, max_mm.y, max_mm.z};
  std::array<float, 3> origin{};
  std::array<double, 3> bricks{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!std::isfinite(low[i]) || !std::isfinite(high[i]) || low[i] > high[i])
      throw std::invalid_argument("the surface's box: found " + base::NumberText(low[i]) + " to " +
                                  base::NumberText(high[i]) + " mm, accepted finite and not empty");
    origin[i] = voxel_mm * (std::floor(low[i] / voxel_mm) - kMarginNodes);
    bricks[i] = std::floor(((high[i] - origin[i]) / voxel_mm + kMarginNodes) / float{kBrickEdge}) + 1.0;
  }
  if (bricks[0] * bricks[1] * bricks[2] > kMaxBricks)
    throw std::invalid_argument("voxel: found " + base::NumberText(voxel_mm) +
                                " mm, accepted for this bone are coarser ones");
  return {.origin_mm = {origin[0], origin[1], origin[2]},
          .voxel_mm = voxel_mm,
          .bricks = {static_cast<int>(bricks[0]), static_cast<int>(bricks[1]), static_cast<int>(bricks[2])}};
}

}  // namespace osteon::surface
