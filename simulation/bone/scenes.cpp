#include "simulation/bone/scenes.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/check_range.h"
#include "simulation/packing/split_packing.h"
#include "simulation/solids/cup_frame.h"

namespace osteon::simulation {
namespace {

/// Checks that the materials have the scene's material names, in the same order. @throws
/// std::invalid_argument
void CheckNames(const std::vector<Material>& materials, const std::vector<std::string>& names) {
  if (materials.size() != names.size())
    throw std::invalid_argument(fmt::format("bone: materials: found {}, accepted exactly {}: {}",
                                            materials.size(), names.size(), fmt::join(names, ", ")));
  for (std::size_t i = 0; i < names.size(); ++i)
    if (materials[i].name != names[i])
      throw std::invalid_argument(
          fmt::format("bone: material {}: found name '{}', accepted '{}'", i, materials[i].name, names[i]));
  CheckMaterials(materials);
}

Bone Assemble(const SceneSolid& solid, const SceneParams& scene, std::vector<Ball> balls,
              std::vector<MassPoint> points) {
  return {.name = solid.name,
          .balls = std::move(balls),
          .points = std::move(points),
          .materials = scene.materials,
          .site = solid.site};
}

/// Returns the site with an axis of unit length. @throws std::invalid_argument if radius, centre or axis is
/// not accepted
CutSite CheckedSite(CutSite cup) {
  const Vector3 center = cup.center_m, axis = cup.axis;
  CheckRangeMm("cup: radius", cup.radius_m, 0.0005, 0.100);
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

/// Fraction of the directions into the cup's lower half in which bone begins between near_m and far_m from
/// the cup's centre.
double ShareWithBoneBetween(const Solid& solid, const CutSite& cup, double near_m, double far_m) {
  const Vector3 z = cup.axis, x = z.unitOrthogonal(), y = z.cross(x);
  constexpr int kDirections = 200;
  int found = 0;
  for (int i = 0; i < kDirections; ++i) {  // Fibonacci spiral: each direction represents an equal area
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

/// Whether the site is an entry: its centre lies within a quarter of the site's radius from the surface;
/// along the axis, the point one radius above is outside the solid and the point one radius below is inside.
bool IsEntry(const Solid& solid, const CutSite& site) {
  const Vector3 center = site.center_m, up = site.radius_m * Vector3(site.axis);
  return std::abs(solid.SignedDistance(center)) <= 0.25 * site.radius_m &&
         solid.SignedDistance(center + up) > 0.0 && solid.SignedDistance(center - up) < 0.0;
}

/// Fraction of the site's circle that is more than a quarter of the site's radius above the surface. It is 1
/// on a ball of less than 1.9 times the site's radius, and 0 on a plane or in a hollow.
double ShareFallenAway(const Solid& solid, const CutSite& site) {
  const Vector3 center = site.center_m, z = site.axis, x = z.unitOrthogonal(), y = z.cross(x);
  constexpr int kDirections = 48;
  int found = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDirections;
    const Vector3 p = center + site.radius_m * (std::cos(angle) * x + std::sin(angle) * y);
    if (solid.SignedDistance(p) > 0.25 * site.radius_m) ++found;
  }
  return static_cast<double>(found) / kDirections;
}

/// Returns the site at the point where the vertical line through (x, y) first meets the solid from above.
CutSite SiteFromAbove(const SiteParams& site, const Solid& solid) {
  CheckRangeMm("site: radius", site.radius_m, 0.0005, 0.100);
  const Eigen::AlignedBox3d box = solid.Bounds();
  constexpr double kTouching_m = 1e-9;  // distance at which the line counts as on the surface
  // Sphere tracing: a step down by the distance to the surface cannot pass the surface.
  Vector3 p(site.x_m, site.y_m, box.max().z() + 1e-3);
  for (double distance_m = 1.0; p.z() > box.min().z();) {
    distance_m = solid.SignedDistance(p);
    if (distance_m < kTouching_m)
      return {.center_m = p, .axis = Vector3(Vector3::UnitZ()), .radius_m = site.radius_m};
    p.z() -= distance_m;
  }
  throw std::invalid_argument(
      fmt::format("site: found ({:g}, {:g}) mm, accepted a place above the solid, which spans "
                  "({:.4g}, {:.4g}) to ({:.4g}, {:.4g}) mm",
                  site.x_m * 1e3, site.y_m * 1e3, box.min().x() * 1e3, box.min().y() * 1e3,
                  box.max().x() * 1e3, box.max().y() * 1e3));
}

// Whether two words are equal, apart from upper and lower case.
bool SameWord(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// Makes the tissue map of a mesh: the tissues of its solid, of its regions by their names, and of the cup's
// lining.
TissueMap TissueOf(const MeshSceneTissue& tissue, const std::vector<MeshRegion>& regions,
                   const CutSite& cup) {
  TissueMap map;
  map.shells = {tissue.solid};
  for (const MeshRegion& region : regions) {
    const auto fits = [&](const MeshSceneTissue::Region& r) {
      return r.name == "*" || SameWord(r.name, region.name);
    };
    const auto found = std::find_if(tissue.regions.begin(), tissue.regions.end(), fits);
    map.shells.push_back(found != tissue.regions.end() ? found->tissue : tissue.solid);
  }
  if (tissue.lining)
    map.lining = LiningTissue{.cup = cup,
                              .lining_radii = tissue.lining->lining_radii,
                              .layers = tissue.lining->layers,
                              .core = tissue.lining->core};
  return map;
}

/// Checks the tissues before the mesh, and so its regions, are known.
void CheckTissue(const MeshSceneTissue& tissue, std::size_t material_count) {
  std::vector<MeshRegion> all_regions(tissue.regions.size());
  for (std::size_t i = 0; i < all_regions.size(); ++i) all_regions[i].name = tissue.regions[i].name;
  CheckTissueMap(TissueOf(tissue, all_regions, CutSite{}), material_count);
}

/// Names of a bone's materials; the first three must be those of BoneTissue.
std::vector<std::string> BoneNames(const std::vector<Material>& materials) {
  std::vector<std::string> names = MaterialNames(AcetabulumShape{});
  if (materials.size() < names.size())
    throw std::invalid_argument(fmt::format("bone: materials: found {}, accepted at least {}: {}",
                                            materials.size(), names.size(), fmt::join(names, ", ")));
  for (std::size_t i = names.size(); i < materials.size(); ++i) names.push_back(materials[i].name);
  return names;
}

}  // namespace

std::vector<std::string> MaterialNames(const SceneShape& shape) {
  if (std::holds_alternative<AcetabulumShape>(shape)) return {"cartilage", "cortical", "cancellous"};
  if (std::holds_alternative<MolarShape>(shape)) return {"enamel", "dentine", "pulp"};
  if (std::holds_alternative<FemurShape>(shape)) return {"cortical", "cancellous", "marrow"};
  if (std::holds_alternative<FemoralHeadShape>(shape)) return {"cartilage", "cortical", "cancellous"};
  return {};
}

void CheckShape(const SceneShape& shape) {
  std::visit([](const auto& s) { CheckShape(s); }, shape);
}

SceneSolid MakeSceneSolid(const SceneParams& scene) {
  if (const auto* cup = std::get_if<AcetabulumShape>(&scene.shape)) {
    const auto solid = std::make_shared<const AcetabulumSolid>(*cup);
    return {.name = fmt::format("acetabulum, cup {:g} mm", 2e3 * cup->cup_radius_m),
            .solid = solid,
            .site = solid->cup()};
  }
  SceneSolid made;
  if (const auto* molar = std::get_if<MolarShape>(&scene.shape)) {
    made.name = fmt::format("molar, {:g} mm", 1e3 * molar->length_m);
    made.solid = std::make_shared<const MolarSolid>(*molar);
  } else if (const auto* femur = std::get_if<FemurShape>(&scene.shape)) {
    made.name = fmt::format("femoral canal, shaft {:g} mm", 2e3 * femur->shaft_radius_m);
    made.solid = std::make_shared<const FemurSolid>(*femur);
  } else if (const auto* head = std::get_if<FemoralHeadShape>(&scene.shape)) {
    made.name = fmt::format("femoral head, {:g} mm", 2e3 * head->head_radius_m);
    made.solid = std::make_shared<const FemoralHeadSolid>(*head);
  } else {
    const auto& block = std::get<BlockShape>(scene.shape);
    made.name = fmt::format("{}, {:g} × {:g} × {:g} mm", scene.name, 1e3 * block.width_m, 1e3 * block.depth_m,
                            1e3 * block.height_m);
    made.solid = std::make_shared<const BoxSolid>(block);
  }
  made.site = SiteFromAbove(scene.site, *made.solid);
  return made;
}

tl::expected<SceneSolid, MeshError> LoadSceneSolid(const std::filesystem::path& path, double scale,
                                                   const CutSite& site, const SceneParams& scene) {
  // check this before loading the mesh, which takes longer
  CheckTissue(scene.mesh_tissue, scene.material_names.size());
  static_cast<void>(CheckedSite(site));
  const auto loaded = LoadMesh(path, {.scale = scale, .remake = true});
  if (!loaded) return tl::make_unexpected(loaded.error());
  return MakeMeshSolid(*loaded, path, site, scene);
}

tl::expected<SceneSolid, MeshError> MakeMeshSolid(const LoadedMesh& loaded, const std::filesystem::path& path,
                                                  const std::optional<CutSite>& site,
                                                  const SceneParams& scene) {
  CheckTissue(scene.mesh_tissue, scene.material_names.size());
  const CutSite checked =
      site ? CheckedSite(*site) : CutSite{.center_m = {}, .axis = Vector3(Vector3::UnitZ()), .radius_m = 0.0};
  TissueMap tissue = TissueOf(scene.mesh_tissue, loaded.regions, checked);
  if (!site) tissue.lining.reset();
  auto solid = std::make_shared<const MeshSolid>(loaded, std::move(tissue));
  SceneSolid made{.name = path.stem().string(), .solid = solid, .site = checked};
  if (loaded.report.remake)
    made.warning = fmt::format("{}: {}", path.string(), DescribeRemake(*loaded.report.remake));
  if (!site) return made;

  // A site is a cup if bone begins between kNear and kFar radii from its centre in at least kMinShare of the
  // directions.
  constexpr double kNear = 0.7, kFar = 1.3, kMinShare = 0.25;
  const double share =
      ShareWithBoneBetween(*solid, checked, kNear * checked.radius_m, kFar * checked.radius_m);
  if (share < kMinShare && !IsEntry(*solid, checked)) {
    const Vector3 c = Vector3(checked.center_m) * 1e3;
    const Vector3 low = solid->Bounds().min() * 1e3, high = solid->Bounds().max() * 1e3;
    return tl::make_unexpected(MeshError{
        MeshErrorKind::kCupOffMesh,
        fmt::format(
            "{}: cup at ({:.4g}, {:.4g}, {:.4g}) mm, radius {:.4g} mm: it does not lie on the bone: found "
            "bone near its radius in {:.0f} % of its lower half, accepted {:.0f} % and more; its centre is "
            "{:.4g} mm from the nearest surface, accepted a quarter of the radius with the outside "
            "above; the mesh spans ({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g}) mm, the axis "
            "points out of the opening",
            path.string(), c.x(), c.y(), c.z(), checked.radius_m * 1e3, 100 * share, 100 * kMinShare,
            std::abs(solid->SignedDistance(checked.center_m)) * 1e3, low.x(), low.y(), low.z(), high.x(),
            high.y(), high.z())});
  }
  // An entry in a scene with a cup zone is accepted if the surface falls away from at most this fraction of
  // the site's circle.
  constexpr double kMaxFallenAway = 0.25;
  const double fallen_away =
      share < kMinShare && scene.zone.kind == ZoneParams::Kind::kCup ? ShareFallenAway(*solid, checked) : 0.0;
  if (fallen_away > kMaxFallenAway) {
    const Vector3 c = Vector3(checked.center_m) * 1e3;
    return tl::make_unexpected(MeshError{
        MeshErrorKind::kCupOffMesh,
        fmt::format(
            "{}: cup at ({:.4g}, {:.4g}, {:.4g}) mm, radius {:.4g} mm: found a convex place (the "
            "surface falls away from {:.0f} % of the cup's rim), accepted a cup, or an entry from "
            "whose rim it falls away in {:.0f} % at most; for a convex site choose a scene whose zone "
            "is a path, such as femoral_head",
            path.string(), c.x(), c.y(), c.z(), checked.radius_m * 1e3, 100 * fallen_away,
            100 * kMaxFallenAway)});
  }
  return made;
}

std::unique_ptr<CutZone> MakeZone(const ZoneParams& zone, const CutSite& site, const Solid& solid) {
  switch (zone.kind) {
    case ZoneParams::Kind::kCup:
      return std::make_unique<CupZone>(site);
    case ZoneParams::Kind::kPath: {
      const Pose X_GC = CupPose(site);
      std::vector<Vector3> path;
      for (const Vector3& p_C : zone.path_C_m) path.push_back(X_GC * p_C);
      return std::make_unique<PathZone>(std::move(path), zone.radius_m);
    }
    case ZoneParams::Kind::kSurface:
      CheckRangeMm("surface zone: radius", zone.radius_m, 0.01e-3, 1.0);
      return std::make_unique<SurfaceZone>(solid, Ball{.center_m = site.center_m, .radius_m = zone.radius_m});
    case ZoneParams::Kind::kEverywhere:
      break;
  }
  return std::make_unique<EverywhereZone>();
}

Bone PackScene(const SceneSolid& solid, const SceneParams& scene, bool split) {
  CheckNames(scene.materials, scene.material_names);  // checked before the packing, which takes longer
  const auto zone = MakeZone(scene.zone, solid.site, *solid.solid);
  return Assemble(solid, scene,
                  split ? BuildSplitPacking(*solid.solid, *zone, SplitPackingFor(scene.packing))
                        : BuildPacking(*solid.solid, *zone, scene.packing),
                  BuildMassPoints(*solid.solid, *zone, scene.points));
}

Bone SceneBone(const SceneSolid& solid, const SceneParams& scene, std::vector<Ball> balls,
               std::vector<MassPoint> points) {
  CheckNames(scene.materials, scene.material_names);
  return Assemble(solid, scene, std::move(balls), std::move(points));
}

Bone MakeAcetabulum(const AcetabulumParams& params) {
  SceneParams scene;
  scene.shape = params.shape;
  scene.material_names = BoneNames(params.materials);
  scene.materials = params.materials;
  scene.packing = params.packing;
  scene.points = params.points;
  return PackScene(MakeSceneSolid(scene), scene);
}

}  // namespace osteon::simulation
