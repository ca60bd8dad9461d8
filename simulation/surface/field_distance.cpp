#include "simulation/surface/field_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osteon::surface {
namespace {

// Returns a node's value [voxels]. Nodes beyond the grid have the value `beyond`.
float NodeValue(const BrickLayout& layout, const BrickField& field, std::array<int, 3> node, float beyond) {
  for (const int along : node)
    if (along < 0) return beyond;
  const int x = node[0] / kBrickEdge, y = node[1] / kBrickEdge, z = node[2] / kBrickEdge;
  if (!layout.Contains(x, y, z)) return beyond;
  const BrickIndex brick = layout.At(x, y, z);
  const std::int16_t* values = field.Values(brick);
  if (!values) return field.State(brick) == BrickField::kAllHigh ? kBandVoxels : -kBandVoxels;
  const int in_brick =
      ((node[2] % kBrickEdge) * kBrickEdge + node[1] % kBrickEdge) * kBrickEdge + node[0] % kBrickEdge;
  return static_cast<float>(values[in_brick]) / static_cast<float>(kStepsOfVoxel);
}

// Interpolates the field between the eight nodes around a place [voxels].
// @param low  lowest of the eight nodes
// @param part  place between them, 0 … 1 along each axis
float Interpolate(const BrickLayout& layout, const BrickField& field, std::array<int, 3> low, Vec3 part,
                  float beyond) {
  float sum = 0.0F;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const float weight = (x == 1 ? part.x : 1.0F - part.x) * (y == 1 ? part.y : 1.0F - part.y) *
                         (z == 1 ? part.z : 1.0F - part.z);
    sum += weight * NodeValue(layout, field, {low[0] + x, low[1] + y, low[2] + z}, beyond);
  }
  return sum;
}

}  // namespace

float CarvedDistance(const BrickLayout& layout, const BrickField& solid, const BrickField& swept, Vec3 p_mm) {
  const Vec3 grid_place = (1.0F / layout.voxel_mm) * (p_mm - layout.origin_mm);
  const float edge = static_cast<float>(kBrickEdge);
  for (const auto& [along, bricks] : {std::pair{grid_place.x, layout.bricks[0]},
                                      {grid_place.y, layout.bricks[1]},
                                      {grid_place.z, layout.bricks[2]}})
    if (!(along > -1.0F && along < edge * static_cast<float>(bricks))) return kBandVoxels * layout.voxel_mm;
  const Vec3 floor{std::floor(grid_place.x), std::floor(grid_place.y), std::floor(grid_place.z)};
  const std::array<int, 3> low{static_cast<int>(floor.x), static_cast<int>(floor.y),
                               static_cast<int>(floor.z)};
  const Vec3 fraction = grid_place - floor;
  // nodes beyond the grid are air, and not swept
  const float carved = std::max(Interpolate(layout, solid, low, fraction, kBandVoxels),
                                Interpolate(layout, swept, low, fraction, -kBandVoxels));
  return layout.voxel_mm * carved;
}

bool SameAround(const CarvedField& field, const CarvedSnapshot& other, BrickIndex brick) {
  const BrickLayout &a = field.layout(), &b = other.solid->layout();
  if (a.bricks != b.bricks || a.voxel_mm != b.voxel_mm || a.origin_mm.x != b.origin_mm.x ||
      a.origin_mm.y != b.origin_mm.y || a.origin_mm.z != b.origin_mm.z)
    return false;
  const auto [x, y, z] = a.PlaceOf(brick);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (!a.Contains(x + dx, y + dy, z + dz)) continue;
        const BrickIndex near = a.At(x + dx, y + dy, z + dz);
        if (!field.swept().SameValues(*other.swept, near) ||
            !field.solid().SameValues(other.solid->distances(), near))
          return false;
      }
  return true;
}

}  // namespace osteon::surface
