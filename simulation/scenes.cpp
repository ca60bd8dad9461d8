#include "simulation/scenes.h"

#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "simulation/check_range.h"

namespace osteon::simulation {
namespace {

void CheckBoneMaterials(const std::vector<Material>& materials) {
  const std::array<std::string, 3> names{"cartilage", "cortical", "cancellous"};
  if (materials.size() < names.size())
    throw std::invalid_argument(fmt::format(
        "bone: materials: found {}, accepted at least 3: cartilage, cortical, cancellous", materials.size()));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (materials[i].name != names[i])
      throw std::invalid_argument(
          fmt::format("bone: material {}: found name '{}', accepted '{}'", i, materials[i].name, names[i]));
  CheckMaterials(materials);
}

Bone Fill(const std::string& name, const Solid& solid, const Cup& cup, const PackingParams& packing,
          const MassPointParams& points, const std::vector<Material>& materials) {
  CheckBoneMaterials(materials);
  const CupZone zone(cup);
  Bone bone;
  bone.name = name;
  bone.balls = BuildPacking(solid, zone, packing);
  bone.points = BuildMassPoints(solid, zone, points);
  bone.materials = materials;
  bone.cup = cup;
  return bone;
}

Cup Checked(Cup cup) {
  const Vector3 center = cup.center_m, axis = cup.axis;
  CheckRangeMm("cup: radius", cup.radius_m, 0.002, 0.100);
  if (!center.allFinite() || center.cwiseAbs().maxCoeff() > 10.0)
    throw std::invalid_argument(
        fmt::format("cup: center: found ({:g}, {:g}, {:g}) mm, accepted within ±10000 mm", center.x() * 1e3,
                    center.y() * 1e3, center.z() * 1e3));
  if (!axis.allFinite() || !(axis.norm() > 1e-6))
    throw std::invalid_argument(fmt::format("cup: axis: found ({:g}, {:g}, {:g}), accepted a direction",
                                            axis.x(), axis.y(), axis.z()));
  cup.axis = Vector3(axis.normalized());
  return cup;
}

void Check(const MeshTissue& t) {
  CheckRangeMm("mesh bone: cartilage thickness", t.cartilage_m, 0.0, 0.020);
  CheckRangeMm("mesh bone: subchondral thickness", t.subchondral_m, 0.0, 0.020);
  CheckRangeMm("mesh bone: cortical thickness", t.cortical_m, 0.0, 0.020);
  if (!(t.lining_radii >= 1.0 && t.lining_radii <= 2.0))
    throw std::invalid_argument(
        fmt::format("mesh bone: lining_radii: found {:g}, accepted 1 … 2", t.lining_radii));
}

/// Share of the directions into the cup's lower half in which bone begins between these distances from the
/// centre.
double ShareWithBoneBetween(const Solid& solid, const Cup& cup, double near_m, double far_m) {
  const Vector3 z = cup.axis, x = z.unitOrthogonal(), y = z.cross(x);
  constexpr int kDirections = 200;
  int found = 0;
  for (int i = 0; i < kDirections; ++i) {  // a Fibonacci spiral: equal areas
    const double height = -(i + 0.5) / kDirections, angle = std::numbers::phi * 2.0 * std::numbers::pi * i;
    const double width = std::sqrt(1.0 - height * height);
    const Vector3 direction = width * (std::cos(angle) * x + std::sin(angle) * y) + height * z;
    const Vector3 center = cup.center_m;
    if (solid.SignedDistance(center + near_m * direction) > 0.0 &&
        solid.SignedDistance(center + far_m * direction) < 0.0)
      ++found;
  }
  return static_cast<double>(found) / kDirections;
}

}  // namespace

Bone MakeAcetabulum(const AcetabulumParams& params) {
  const AcetabulumSolid solid(params.shape);
  return Fill(fmt::format("acetabulum, cup {:g} mm", 2e3 * params.shape.cup_radius_m), solid, solid.cup(),
              params.packing, params.points, params.materials);
}

tl::expected<std::shared_ptr<const MeshSolid>, MeshError> LoadMeshSolid(const std::filesystem::path& path,
                                                                        const Cup& cup,
                                                                        const MeshTissue& tissue) {
  Check(tissue);
  const Cup checked = Checked(cup);
  auto loaded = LoadMesh(path);
  if (!loaded) return tl::make_unexpected(loaded.error());
  auto solid = std::make_shared<const MeshSolid>(*loaded, CupBoneTissue(tissue, checked));

  constexpr double kNear = 0.7, kFar = 1.3, kLeastShare = 0.25;
  const double share =
      ShareWithBoneBetween(*solid, checked, kNear * checked.radius_m, kFar * checked.radius_m);
  if (share < kLeastShare) {
    const Vector3 c = Vector3(checked.center_m) * 1e3;
    const Vector3 low = solid->Bounds().min() * 1e3, high = solid->Bounds().max() * 1e3;
    return tl::make_unexpected(
        MeshError{MeshErrorKind::kCupOffMesh,
                  fmt::format("{}: cup at ({:.4g}, {:.4g}, {:.4g}) mm, radius {:.4g} mm: found bone to begin "
                              "within 30 % of the "
                              "radius in {:.0f} % of its lower half, accepted {:.0f} % and more; the mesh "
                              "spans ({:.4g}, {:.4g}, "
                              "{:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm, the axis points out of the opening",
                              path.string(), c.x(), c.y(), c.z(), checked.radius_m * 1e3, 100 * share,
                              100 * kLeastShare, low.x(), low.y(), low.z(), high.x(), high.y(), high.z())});
  }
  return solid;
}

Bone PackMeshBone(const std::filesystem::path& path, const MeshSolid& solid, const MeshBoneParams& params) {
  return Fill(path.stem().string(), solid, solid.tissue().lining.value().cup, params.packing, params.points,
              params.materials);
}

tl::expected<Bone, MeshError> MakeBoneFromMesh(const std::filesystem::path& path, const Cup& cup,
                                               const MeshBoneParams& params) {
  const auto solid = LoadMeshSolid(path, cup, params.tissue);
  if (!solid) return tl::make_unexpected(solid.error());
  return PackMeshBone(path, **solid, params);
}

}  // namespace osteon::simulation
