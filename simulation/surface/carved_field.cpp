#include "simulation/surface/carved_field.h"

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace osteon::surface {
namespace {

/// The mesh depends only on values of at most this size. The corners of a cell that the surface passes lie
/// within the cell's diagonal (1.74 voxels) of the surface, and central differences reach one node further.
constexpr auto kVisible = static_cast<std::int16_t>(11 * kStepsOfVoxel / 4);

/// The changes that a sweep made in a brick.
struct BrickChange {
  bool is_visible{false}, is_full{false};
  /// Coordinates at which nodes changed visibly, along x, y and z: bit i for coordinate i.
  std::array<unsigned, 3> rows{};
};

/// Compares a brick's swept values before and after a sweep.
/// @param solid  the solid's values at the nodes; null: the brick lies entirely inside the solid
BrickChange CompareBrick(const std::int16_t* before, const std::int16_t* after, const std::int16_t* solid) {
  BrickChange change{.is_full = true};
  const auto seen = [](std::int16_t v) {
    return std::clamp<std::int16_t>(v, static_cast<std::int16_t>(-kVisible), kVisible);
  };
  for (int i = 0; i < kBrickNodes; ++i) {
    change.is_full = change.is_full && after[i] == kFieldLimit;
    if (before[i] == after[i] || seen(before[i]) == seen(after[i])) continue;
    if (solid && solid[i] > kVisible) continue;  // the node is in the air
    change.is_visible = true;
    change.rows[0] |= 1U << (i & 7);
    change.rows[1] |= 1U << (i >> 3 & 7);
    change.rows[2] |= 1U << (i >> 6);
  }
  return change;
}

/// Whether the neighbour at this offset reads nodes of these coordinates: the cells and normals of a chunk
/// use nodes up to two beyond its brick.
bool Reaches(unsigned rows, int offset) {
  return offset == 0 || (offset < 0 ? (rows & 0x03U) != 0 : (rows & 0xc0U) != 0);
}

/// Calls visit(dx, dy, dz) for the offsets of a brick itself and its 26 neighbours.
template <class Visit>
void EachNeighbour(const Visit& visit) {
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) visit(dx, dy, dz);
}

}  // namespace

CarvedField::CarvedField(std::shared_ptr<const SolidField> solid)
    : solid_(std::move(solid)),
      swept_(layout().Count(), BrickField::kAllLow),
      is_dirty_(layout().Count(), false) {
  MarkAllDirty();
}

void CarvedField::MarkAllDirty() {
  for (BrickIndex brick = 0; brick < layout().Count(); ++brick) {
    const auto [x, y, z] = layout().PlaceOf(brick);
    bool surface = solid().HasValues(brick) || swept_.HasValues(brick);
    // The surface may also lie between a brick in the bone and a neighbour that is uniform air.
    if (!surface && solid().State(brick) == BrickField::kAllLow)
      EachNeighbour([&, x = x, y = y, z = z](int dx, int dy, int dz) {
        surface = surface || !layout().Contains(x + dx, y + dy, z + dz) ||
                  solid().State(layout().At(x + dx, y + dy, z + dz)) == BrickField::kAllHigh;
      });
    if (surface)
      EachNeighbour([&, x = x, y = y, z = z](int dx, int dy, int dz) { MarkDirty(x + dx, y + dy, z + dz); });
  }
}

void CarvedField::Carve(std::span<const Capsule> capsules) {
  if (capsules.empty()) return;
  constexpr float kFar = std::numeric_limits<float>::max();
  const float band_mm = kBandVoxels * layout().voxel_mm, edge_mm = layout().voxel_mm * kBrickEdge;
  std::array<float, 3> low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Capsule& capsule : capsules)
    for (const Vec3& end : {capsule.a_mm - layout().origin_mm, capsule.b_mm - layout().origin_mm}) {
      const std::array<float, 3> p{end.x, end.y, end.z};
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], p[i] - capsule.radius_mm - band_mm);
        high[i] = std::max(high[i], p[i] + capsule.radius_mm + band_mm);
      }
    }
  // lowest and highest bricks that the capsules, with the field's band around them, reach
  std::array<int, 3> from{}, to{};
  for (std::size_t i = 0; i < 3; ++i) {
    const float last = static_cast<float>(layout().bricks[i]);
    from[i] = static_cast<int>(std::clamp(std::floor(low[i] / edge_mm), 0.0F, last));
    to[i] = static_cast<int>(std::clamp(std::floor(high[i] / edge_mm) + 1.0F, 0.0F, last));
  }
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y)
      for (int x = from[0]; x < to[0]; ++x) CarveBrick(x, y, z, capsules);
}

void CarvedField::SetSwept(BrickField swept) {
  if (swept.Count() != layout().Count())
    throw std::invalid_argument("carved field: found " + std::to_string(swept.Count()) +
                                " bricks of a sweep, accepted " + std::to_string(layout().Count()));
  const BrickField before = std::exchange(swept_, std::move(swept));
  for (BrickIndex brick = 0; brick < layout().Count(); ++brick) {
    if (before.SameValues(swept_, brick)) continue;
    const auto [x, y, z] = layout().PlaceOf(brick);
    EachNeighbour([&, x = x, y = y, z = z](int dx, int dy, int dz) { MarkDirty(x + dx, y + dy, z + dz); });
  }
}

void CarvedField::CarveBrick(int x, int y, int z, std::span<const Capsule> capsules) {
  const BrickIndex brick = layout().At(x, y, z);
  if (solid().State(brick) == BrickField::kAllHigh || swept_.State(brick) == BrickField::kAllHigh) return;
  const float voxel_mm = layout().voxel_mm, half_mm = kHalfDiagonalVoxels * voxel_mm;
  const float reach_mm = kBandVoxels * voxel_mm + half_mm;
  const Vec3 first = layout().Node(x * kBrickEdge, y * kBrickEdge, z * kBrickEdge);
  const Vec3 centre = first + 0.5F * 7.0F * voxel_mm * Vec3{1.0F, 1.0F, 1.0F};
  depths_.clear();
  float deepest_mm = -std::numeric_limits<float>::max();
  for (const Capsule& capsule : capsules) {
    depths_.push_back(DepthIn(capsule, centre));
    deepest_mm = std::max(deepest_mm, depths_.back());
  }
  if (!(deepest_mm > -reach_mm)) return;
  if (deepest_mm >= reach_mm) {
    swept_.MakeUniform(brick, BrickField::kAllHigh);
    EachNeighbour([&](int dx, int dy, int dz) { MarkDirty(x + dx, y + dy, z + dz); });
    return;
  }
  SelectCapsules(capsules, depths_, reach_mm, half_mm, selected_);
  std::int16_t* values = swept_.HasValues(brick) ? swept_.Values(brick) : swept_.MakeValues(brick);
  std::array<std::int16_t, kBrickNodes> before;
  std::copy_n(values, kBrickNodes, before.begin());
  for (const std::uint32_t k : selected_) SweepBrick(values, first, voxel_mm, capsules[k]);
  const BrickChange change = CompareBrick(before.data(), values, solid().Values(brick));
  if (change.is_full) swept_.MakeUniform(brick, BrickField::kAllHigh);
  if (!change.is_visible) return;
  EachNeighbour([&](int dx, int dy, int dz) {
    if (Reaches(change.rows[0], dx) && Reaches(change.rows[1], dy) && Reaches(change.rows[2], dz))
      MarkDirty(x + dx, y + dy, z + dz);
  });
}

void CarvedField::MarkDirty(int x, int y, int z) {
  if (!layout().Contains(x, y, z)) return;
  const BrickIndex brick = layout().At(x, y, z);
  if (is_dirty_[brick]) return;
  is_dirty_[brick] = true;
  dirty_list_.push_back(brick);
}

void CarvedField::ClearDirty() {
  for (const BrickIndex brick : dirty_list_) is_dirty_[brick] = false;
  dirty_list_.clear();
}

}  // namespace osteon::surface
