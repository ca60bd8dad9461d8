#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "simulation/bone/scene_events.h"
#include "simulation/mesh/triangle_mesh.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/solids/acetabulum_solid.h"
#include "simulation/solids/box_solid.h"
#include "simulation/solids/femoral_head_solid.h"
#include "simulation/solids/femur_solid.h"
#include "simulation/solids/mesh_solid.h"
#include "simulation/solids/molar_solid.h"

namespace osteon::simulation {

/// A solid that can be generated.
using SceneShape = std::variant<AcetabulumShape, MolarShape, FemurShape, BlockShape, FemoralHeadShape>;

/// Names of the materials to which a shape's material indices refer, by index. Empty for a block, whose
/// layers state their own indices.
[[nodiscard]] std::vector<std::string> MaterialNames(const SceneShape& shape);

/// Checks the sizes of a shape.
/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const SceneShape& shape);

/// Site at which a generated solid is cut: a circle on its upper surface, seen along G's z axis. For an
/// acetabulum the site is always its cup, and these parameters are ignored.
struct SiteParams {
  double x_m{0.0}, y_m{0.0};  ///< centre in G; its height follows from the surface
  double radius_m{0.005};
};

/// Zone in which a bone is packed finely (cut_zone.h), relative to its site.
struct ZoneParams {
  enum class Kind : std::uint8_t { kCup, kPath, kSurface, kEverywhere };
  Kind kind{Kind::kCup};
  double radius_m{0.0};           ///< kPath: the tool's radius; kSurface: radius around the site
  std::vector<Vector3> path_C_m;  ///< kPath: positions of the tool's centre, in the site's frame C
};

/// Tissues of a mesh in a scene: of the solid, of its named regions, and of a cup's lining.
struct MeshSceneTissue {
  struct Region {
    std::string name;  ///< name of the mesh's region, case ignored; "*": any region
    ShellTissue tissue;
  };
  struct Lining {  // see LiningTissue
    double lining_radii{1.25};
    std::vector<TissueLayer> layers;
    MaterialIndex core{0};
  };
  ShellTissue solid;
  std::vector<Region> regions;  ///< for each mesh region the first match; else the solid's tissue
  std::optional<Lining> lining;
};

/// Requested accuracy and rate of a scene's model. The planner chooses the packing for them
/// (docs/planning.md).
struct FidelityRequest {
  double error_m{0.1e-3};  ///< mean depth error of a cut against its sweep
  double rate_hz{250.0};   ///< frames per second
};

/// A scene: its solid, its materials, and how finely it is packed.
struct SceneParams {
  std::string name{"block"};  ///< name of a block; other shapes have their own names
  SceneShape shape;
  SiteParams site;
  ZoneParams zone;
  MeshSceneTissue mesh_tissue;
  std::vector<std::string> material_names;  ///< names for the indices of shape and mesh tissue
  std::vector<Material> materials;          ///< one material for each name, in the same order
  PackingParams packing;
  std::optional<FidelityRequest> fidelity;  ///< absent: `packing` is used as it is
  MassPointParams points;
  SceneEventParams events;
};

/// A solid and the site where it is cut.
struct SceneSolid {
  std::string name;
  std::shared_ptr<const Solid> solid;
  CutSite site;           ///< the site, in G
  std::string warning{};  ///< assumptions about a mesh that bounds no solid; empty: nothing was assumed
};

/// Makes the scene's generated solid. The site's centre is the point where the vertical line through the
/// site's (x, y) first meets the solid from above.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] SceneSolid MakeSceneSolid(const SceneParams& scene);

/// Loads the solid of a mesh file (see LoadMesh) in place of the scene's generated solid. One unit of the
/// file is `scale` millimetres; G is the file's frame, scaled. The surface of a mesh that bounds no solid is
/// remade (MeshRemake).
///
/// The site must be on the mesh, as a cup or as an entry. A cup: in at least a quarter of the directions into
/// its lower half, bone begins between 70 and 130 % of its radius. An entry: its centre is within a quarter
/// of its radius from the surface, and along the axis the surface lies between one radius above and one
/// radius below the centre. On a convex surface an entry is accepted only if the scene's zone is no cup.
/// @param site  the site, in G; its axis may have any length
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] tl::expected<SceneSolid, MeshError> LoadSceneSolid(const std::filesystem::path& path,
                                                                 double scale, const CutSite& site,
                                                                 const SceneParams& scene);

/// Makes the scene's solid in the same way from a mesh that was read before; the path is used only for names
/// and messages. Without a site there is no lining and no check of the site's place; the site's radius is
/// then 0.
[[nodiscard]] tl::expected<SceneSolid, MeshError> MakeMeshSolid(const LoadedMesh& loaded,
                                                                const std::filesystem::path& path,
                                                                const std::optional<CutSite>& site,
                                                                const SceneParams& scene);

/// Makes the zone in which a solid is packed finely.
/// @param solid  must outlive the zone
/// @throws std::invalid_argument if the zone's parameters are not accepted.
[[nodiscard]] std::unique_ptr<CutZone> MakeZone(const ZoneParams& zone, const CutSite& site,
                                                const Solid& solid);

/// Fills the solid with balls and mass points, as finely as the scene's packing says.
/// @param split  the engine is going to split balls that a tool touches (SplitParams): the packing then has
/// few large balls (SplitPackingFor)
/// @throws std::invalid_argument naming the parameter, its value and what is accepted; also if the materials
/// do not have the scene's names, or the solid takes more than 100 million cells.
[[nodiscard]] Bone PackScene(const SceneSolid& solid, const SceneParams& scene, bool split = false);

/// Makes the scene's bone from given balls and mass points, with the scene's materials and site.
/// @throws std::invalid_argument if the materials do not have the scene's names.
[[nodiscard]] Bone SceneBone(const SceneSolid& solid, const SceneParams& scene, std::vector<Ball> balls,
                             std::vector<MassPoint> points);

/// Parameters of a generated acetabulum that is made without a scene.
struct AcetabulumParams {
  AcetabulumShape shape;
  PackingParams packing;
  MassPointParams points;
  std::vector<Material> materials{DefaultBoneMaterials()};  ///< the first three are those of BoneTissue
};

/// Makes a packed block with a hemispherical cup; G's origin is the cup's centre, its +z points out of the
/// cup.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] Bone MakeAcetabulum(const AcetabulumParams& params);

}  // namespace osteon::simulation
