#include "simulation/surface/solid_field.h"

#include <array>
#include <vector>

#include "base/parallel.h"

namespace osteon::surface {
namespace {

/// Number of bricks along a block's edge. A block whose centre is far from the surface is not sampled
/// further.
constexpr int kBlockEdge = 4;

/// Centre [mm] of a cube of `bricks`³ bricks.
/// @param brick  lowest brick of the cube
Vec3 CentreOf(const BrickLayout& layout, const std::array<int, 3>& brick, int bricks) {
  const float half_mm = 0.5F * layout.voxel_mm * static_cast<float>(kBrickEdge * bricks - 1);
  return layout.Node(brick[0] * kBrickEdge, brick[1] * kBrickEdge, brick[2] * kBrickEdge) +
         half_mm * Vec3{1.0F, 1.0F, 1.0F};
}

/// Reach [mm] of a cube of `bricks`³ bricks: half its diagonal plus the field's limit of 3 voxels, with a
/// margin for rounding.
float ReachOf(const BrickLayout& layout, int bricks) {
  constexpr float kRounding = 0.01F;
  return layout.voxel_mm *
         (kHalfDiagonalVoxels / 7.0F * static_cast<float>(kBrickEdge * bricks - 1) + kBandVoxels + kRounding);
}

/// Calls visit(place) for every `step`-th place in the box from `from` (included) to `to` (excluded).
template <class Visit>
void EachBrick(const std::array<int, 3>& from, const std::array<int, 3>& to, int step, const Visit& visit) {
  for (int z = from[2]; z < to[2]; z += step)
    for (int y = from[1]; y < to[1]; y += step)
      for (int x = from[0]; x < to[0]; x += step) visit(std::array<int, 3>{x, y, z});
}

/// The field in one brick, before it is stored in the whole field.
struct SampledBrick {
  BrickIndex brick{0};
  std::int32_t state{BrickField::kAllHigh};  ///< state, if the brick is uniform
  std::vector<std::int16_t> values;          ///< empty: the brick is uniform
};

/// Samples a row of eight nodes along x. If a node is far from the surface, the next nodes are at the same
/// limit, because the distance changes by at most one voxel per node. These nodes are not sampled.
void SampleRow(const BrickLayout& layout, const DistanceAt& distance, const std::array<int, 3>& first,
               std::int16_t* values) {
  int known = 0;  // number of following nodes that are known to have the same value
  for (int x = 0; x < kBrickEdge; ++x) {
    if (known > 0) {
      values[x] = values[x - 1];
      --known;
      continue;
    }
    const double distance_mm = distance(layout.Node(first[0] + x, first[1], first[2]));
    values[x] = ToFieldValue(distance_mm, layout.voxel_mm);
    known = static_cast<int>(std::abs(distance_mm) / static_cast<double>(layout.voxel_mm) -
                             static_cast<double>(kBandVoxels));
  }
}

/// Samples one brick. It stays uniform if its centre is far from the surface.
SampledBrick SampleBrick(const BrickLayout& layout, const DistanceAt& distance,
                         const std::array<int, 3>& place) {
  SampledBrick sampled{.brick = layout.At(place[0], place[1], place[2]), .values = {}};
  const double centre_mm = distance(CentreOf(layout, place, 1));
  if (std::abs(centre_mm) > ReachOf(layout, 1)) {
    sampled.state = centre_mm < 0.0 ? BrickField::kAllLow : BrickField::kAllHigh;
    return sampled;
  }
  std::vector<std::int16_t> values(kBrickNodes);
  for (int row = 0; row < kBrickEdge * kBrickEdge; ++row)
    SampleRow(layout, distance,
              {place[0] * kBrickEdge, place[1] * kBrickEdge + (row & 7), place[2] * kBrickEdge + (row >> 3)},
              values.data() + row * kBrickEdge);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (*high == -kFieldLimit)
    sampled.state = BrickField::kAllLow;
  else if (*low != kFieldLimit)
    sampled.values = std::move(values);
  return sampled;
}

/// Samples the bricks of a block that are not all air.
std::vector<SampledBrick> SampleBlock(const BrickLayout& layout, const DistanceAt& distance,
                                      const std::array<int, 3>& block) {
  std::vector<SampledBrick> bricks;
  const double centre_mm = distance(CentreOf(layout, block, kBlockEdge));
  const bool is_far = std::abs(centre_mm) > ReachOf(layout, kBlockEdge);
  if (is_far && centre_mm > 0.0) return bricks;
  std::array<int, 3> end{};
  for (std::size_t i = 0; i < 3; ++i) end[i] = std::min(block[i] + kBlockEdge, layout.bricks[i]);
  EachBrick(block, end, 1, [&](const std::array<int, 3>& place) {
    SampledBrick brick{
        .brick = layout.At(place[0], place[1], place[2]), .state = BrickField::kAllLow, .values = {}};
    if (!is_far) brick = SampleBrick(layout, distance, place);
    if (!brick.values.empty() || brick.state == BrickField::kAllLow) bricks.push_back(std::move(brick));
  });
  return bricks;
}

}  // namespace

SolidField::SolidField(const BrickLayout& layout, const DistanceAt& distance)
    : layout_(layout), distances_(layout.Count(), BrickField::kAllHigh) {
  std::vector<std::array<int, 3>> blocks;
  EachBrick({0, 0, 0}, layout.bricks, kBlockEdge,
            [&](const std::array<int, 3>& block) { blocks.push_back(block); });
  std::vector<std::vector<SampledBrick>> sampled(blocks.size());
  simulation::ParallelFor(
      blocks.size(), 0,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sampled[i] = SampleBlock(layout, distance, blocks[i]);
      },
      1);
  for (const std::vector<SampledBrick>& bricks : sampled)
    for (const SampledBrick& brick : bricks) {
      if (brick.values.empty())
        distances_.MakeUniform(brick.brick, brick.state);
      else
        std::copy(brick.values.begin(), brick.values.end(), distances_.MakeValues(brick.brick));
    }
}

SolidField::SolidField(const BrickLayout& layout, std::span<const Capsule> balls)
    : layout_(layout), distances_(layout.Count(), BrickField::kAllLow) {
  const float edge_mm = layout.voxel_mm * kBrickEdge, reach_mm = ReachOf(layout, 1);
  // First compute depths in the balls, as for swept capsules; the distances are the negated depths.
  for (const Capsule& ball : balls) {
    const float around_mm = ball.radius_mm + kBandVoxels * layout.voxel_mm;
    const Vec3 offset = ball.a_mm - layout.origin_mm;
    const std::array<float, 3> centre{offset.x, offset.y, offset.z};
    std::array<int, 3> from{}, to{};
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = std::max(0, static_cast<int>(std::floor((centre[i] - around_mm) / edge_mm)));
      to[i] = std::min(layout.bricks[i], static_cast<int>(std::floor((centre[i] + around_mm) / edge_mm)) + 1);
    }
    EachBrick(from, to, 1, [&](const std::array<int, 3>& p) {
      const BrickIndex brick = layout.At(p[0], p[1], p[2]);
      const float depth_mm = DepthIn(ball, CentreOf(layout, p, 1));
      if (distances_.State(brick) == BrickField::kAllHigh || depth_mm <= -reach_mm) return;
      if (depth_mm >= reach_mm) {
        distances_.MakeUniform(brick, BrickField::kAllHigh);
        return;
      }
      if (!distances_.HasValues(brick)) distances_.MakeValues(brick);
      SweepBrick(distances_.Values(brick),
                 layout.Node(p[0] * kBrickEdge, p[1] * kBrickEdge, p[2] * kBrickEdge), layout.voxel_mm, ball);
    });
  }
  for (BrickIndex brick = 0; brick < layout.Count(); ++brick) {
    if (std::int16_t* values = distances_.Values(brick)) {
      for (int i = 0; i < kBrickNodes; ++i) values[i] = static_cast<std::int16_t>(-values[i]);
    } else {
      distances_.MakeUniform(brick, distances_.State(brick) == BrickField::kAllHigh ? BrickField::kAllLow
                                                                                    : BrickField::kAllHigh);
    }
  }
}

}  // namespace osteon::surface
