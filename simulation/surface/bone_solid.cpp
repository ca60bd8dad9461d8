#include "simulation/surface/bone_solid.h"

#include <utility>

#include "simulation/surface/millimetres.h"

namespace osteon::surface {

std::shared_ptr<const SolidField> SampleSolid(const simulation::Solid& solid, float voxel_mm) {
  const Eigen::AlignedBox3d box = solid.Bounds();
  const BrickLayout layout = MakeLayout(ToMillimetres(box.min()), ToMillimetres(box.max()), voxel_mm);
  return std::make_shared<const SolidField>(
      layout, [&solid](Vec3 p_mm) { return 1e3 * solid.SignedDistance(ToMetres(p_mm)); });
}

MaterialAt TissueOf(std::shared_ptr<const simulation::Solid> solid) {
  return [solid = std::move(solid)](Vec3 p_mm) {
    return static_cast<std::uint8_t>(solid->MaterialAt(ToMetres(p_mm)));
  };
}

std::shared_ptr<const SolidField> UnionOfBalls(const simulation::Bone& bone, float voxel_mm) {
  std::vector<Capsule> balls;
  Eigen::AlignedBox3d box;
  for (const simulation::Ball& ball : bone.balls) {
    if (!(ball.radius_m > 0.0)) continue;
    const Vector3 centre(ball.center_m), r = Vector3::Constant(ball.radius_m);
    box.extend(centre - r);
    box.extend(centre + r);
    const Vec3 p = ToMillimetres(centre);
    balls.push_back({.a_mm = p, .b_mm = p, .radius_mm = static_cast<float>(1e3 * ball.radius_m)});
  }
  const BrickLayout layout = MakeLayout(ToMillimetres(box.min()), ToMillimetres(box.max()), voxel_mm);
  return std::make_shared<const SolidField>(layout, std::span<const Capsule>(balls));
}

std::shared_ptr<const SolidField> FieldOfBone(const simulation::Solid* solid, const simulation::Bone& bone,
                                              float voxel_mm) {
  return solid ? SampleSolid(*solid, voxel_mm) : UnionOfBalls(bone, voxel_mm);
}

}  // namespace osteon::surface
