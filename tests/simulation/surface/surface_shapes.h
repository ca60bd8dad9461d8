#pragma once

#include <memory>
#include <random>
#include <vector>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// A ball around the origin; exact distances.
inline std::shared_ptr<const SolidField> BallField(float radius_mm, float voxel_mm) {
  const Vec3 corner{radius_mm, radius_mm, radius_mm};
  return std::make_shared<const SolidField>(
      MakeLayout(-1.0F * corner, corner, voxel_mm),
      [radius_mm](Vec3 p) { return static_cast<double>(Norm(p) - radius_mm); });
}

/// A block from z = -depth to 0, around the origin; exact distances.
inline std::shared_ptr<const SolidField> BlockField(float half_mm, float depth_mm, float voxel_mm) {
  const Vec3 half{half_mm, half_mm, 0.5F * depth_mm}, centre{0.0F, 0.0F, -0.5F * depth_mm};
  return std::make_shared<const SolidField>(
      MakeLayout(centre - half, centre + half, voxel_mm), [half, centre](Vec3 p) {
        const Vec3 q = p - centre;
        const Vec3 d{std::abs(q.x) - half.x, std::abs(q.y) - half.y, std::abs(q.z) - half.z};
        const Vec3 out{std::max(d.x, 0.0F), std::max(d.y, 0.0F), std::max(d.z, 0.0F)};
        return static_cast<double>(Norm(out) + std::min(0.0F, std::max({d.x, d.y, d.z})));
      });
}

/// A ball's random walk: starts in a cube of half size reach_mm; each step is 0.3 mm per axis (one sigma).
inline std::vector<Capsule> RandomToolPath(std::mt19937& random, float reach_mm, float radius_mm, int count) {
  std::uniform_real_distribution<float> place(-reach_mm, reach_mm);
  std::normal_distribution<float> step(0.0F, 0.3F);
  Vec3 at{place(random), place(random), place(random)};
  std::vector<Capsule> way;
  for (int i = 0; i < count; ++i) {
    const Vec3 next = at + Vec3{step(random), step(random), step(random)};
    way.push_back({.a_mm = at, .b_mm = next, .radius_mm = radius_mm});
    at = next;
  }
  return way;
}

}  // namespace osteon::surface
