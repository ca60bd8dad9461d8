#include "simulation/surface/tissue_bricks.h"

#include <utility>

namespace osteon::surface {

TissueBricks::TissueBricks(const BrickLayout& layout, MaterialAt at)
    : layout_(layout), at_(std::move(at)), tissue_(layout.Count(), at_ ? kUnknown : std::uint8_t{0}) {}

std::uint8_t TissueBricks::At(BrickIndex brick, Vec3 p_mm) {
  std::uint8_t& tissue = tissue_[brick];
  if (tissue == kUnknown) tissue = Sample(brick);
  return tissue == kMixed ? at_(p_mm) : tissue;
}

// A chunk's vertices lie in the cells -1 … 7, so the sampled places reach from node -1 to node 8.
std::uint8_t TissueBricks::Sample(BrickIndex brick) const {
  constexpr int kStep = kCellEdge / 3;
  const auto [x, y, z] = layout_.PlaceOf(brick);
  const auto place = [&](int i, int j, int k) {
    return at_(layout_.Node(x * kBrickEdge - 1 + kStep * i, y * kBrickEdge - 1 + kStep * j,
                            z * kBrickEdge - 1 + kStep * k));
  };
  const std::uint8_t first = place(0, 0, 0);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        if (place(i, j, k) != first) return kMixed;
  return first;
}

}  // namespace osteon::surface
