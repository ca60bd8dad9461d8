#include "simulation/surface/capsule.h"

#include <algorithm>
#include <array>

#include "simulation/surface/brick_field.h"

// Do not let a square root set errno: this would keep GCC from vectorising the loop.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC push_options
#pragma GCC optimize("O3", "no-math-errno")
#endif

namespace osteon::surface {

void SweepBrick(std::int16_t* values, Vec3 first, float voxel_mm, const Capsule& capsule) {
  const Vec3 along = capsule.b_mm - capsule.a_mm;
  const float length2 = Dot(along, along), inverse = length2 > 0.0F ? 1.0F / length2 : 0.0F;
  const float steps_per_mm = kStepsOfVoxel / voxel_mm;
  constexpr float kLimit = kFieldLimit;
  std::array<float, kBrickEdge> from_a{};
  for (int x = 0; x < kBrickEdge; ++x)
    from_a[static_cast<std::size_t>(x)] = (first.x - capsule.a_mm.x) + voxel_mm * static_cast<float>(x);
  for (int z = 0; z < kBrickEdge; ++z)
    for (int y = 0; y < kBrickEdge; ++y) {
      const float py = (first.y - capsule.a_mm.y) + voxel_mm * static_cast<float>(y);
      const float pz = (first.z - capsule.a_mm.z) + voxel_mm * static_cast<float>(z);
      const float dot_yz = py * along.y + pz * along.z;
      std::int16_t* row = values + (z * kBrickEdge + y) * kBrickEdge;
      // This loop has no branches, so that compilers vectorise it.
      std::array<float, kBrickEdge> depth{};
      for (std::size_t x = 0; x < kBrickEdge; ++x) {
        const float px = from_a[x];
        float t = (px * along.x + dot_yz) * inverse;
        t = t > 0.0F ? t : 0.0F;
        t = t < 1.0F ? t : 1.0F;
        const float dx = px - t * along.x, dy = py - t * along.y, dz = pz - t * along.z;
        float d = (capsule.radius_mm - std::sqrt(dx * dx + dy * dy + dz * dz)) * steps_per_mm;
        d = d > -kLimit ? d : -kLimit;
        depth[x] = d < kLimit ? d : kLimit;
      }
      for (std::size_t x = 0; x < kBrickEdge; ++x) {
        const auto value = static_cast<std::int16_t>(static_cast<std::int32_t>(depth[x]));
        row[x] = row[x] > value ? row[x] : value;
      }
    }
}

}  // namespace osteon::surface

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif

namespace osteon::surface {

float DepthIn(const Capsule& capsule, Vec3 point) {
  const Vec3 along = capsule.b_mm - capsule.a_mm, from_a = point - capsule.a_mm;
  const float length2 = Dot(along, along);
  const float t = length2 > 0.0F ? std::clamp(Dot(from_a, along) / length2, 0.0F, 1.0F) : 0.0F;
  return capsule.radius_mm - Norm(from_a - t * along);
}

// Capsule A is deeper than capsule B at a brick's centre. B can only be deeper at a node if the directions
// from there to both axes differ. The difference of these unit vectors is at most the distance between the
// axes, divided by the axes' distance from the brick. This difference, times half the brick's diagonal,
// bounds the depth that B gains on A between the centre and a node.
void SelectCapsules(std::span<const Capsule> capsules, std::span<const float> depths, float reach_mm,
                    float half_mm, std::vector<std::uint32_t>& kept) {
  constexpr float kRoundingMargin = 1.01F;
  constexpr float kMaxGain = 2.0F;  // largest difference of two unit vectors, if they are opposite
  kept.clear();
  const std::size_t deepest =
      static_cast<std::size_t>(std::max_element(depths.begin(), depths.end()) - depths.begin());
  const Capsule& deepest_capsule = capsules[deepest];
  for (std::size_t k = 0; k < capsules.size(); ++k) {
    if (depths[k] <= -reach_mm) continue;
    if (k != deepest) {
      const Capsule& other = capsules[k];
      const float apart_mm =
          std::max({Norm(other.a_mm - deepest_capsule.a_mm), Norm(other.a_mm - deepest_capsule.b_mm),
                    Norm(other.b_mm - deepest_capsule.a_mm), Norm(other.b_mm - deepest_capsule.b_mm)});
      const float near_mm =
          std::min(other.radius_mm - depths[k], deepest_capsule.radius_mm - depths[deepest]) - half_mm;
      const float gain_mm = half_mm * (near_mm > 0.0F ? std::min(kMaxGain, apart_mm / near_mm) : kMaxGain);
      if (depths[k] + kRoundingMargin * gain_mm < depths[deepest]) continue;
    }
    kept.push_back(static_cast<std::uint32_t>(k));
  }
}

}  // namespace osteon::surface
