#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <variant>

#include "simulation/mesh/triangle_mesh.h"
#include "simulation/packing/mass_points.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/scene_events.h"
#include "simulation/solids/acetabulum_solid.h"
#include "simulation/solids/box_solid.h"
#include "simulation/solids/femoral_head_solid.h"
#include "simulation/solids/femur_solid.h"
#include "simulation/solids/mesh_solid.h"
#include "simulation/solids/molar_solid.h"

namespace osteon::simulation {

/// A solid that can be generated.
using SceneShape = std::variant<AcetabulumShape, MolarShape, FemurShape, BlockShape, FemoralHeadShape>;

/// The names of the materials that a shape speaks of, in the order of its indices; none for a block, whose
/// layers carry indices of their own.
[[nodiscard]] std::vector<std::string> MaterialNames(const SceneShape& shape);

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const SceneShape& shape);

/// Where a generated solid is cut: a circle on its upper surface, seen along G's z axis. An acetabulum's site
/// is its cup, whatever this says.
struct SiteParams {
  double x_m{0.0}, y_m{0.0};
  double radius_m{0.005};
};

/// Where a bone is fine (cut_zone.h), relative to its site.
struct ZoneParams {
  enum class Kind : std::uint8_t { kCup, kPath, kSurface, kEverywhere };
  Kind kind{Kind::kCup};
  double radius_m{0.0};           ///< of the path's tool, or of the region of the surface around the site
  std::vector<Vector3> path_C_m;  ///< of the tool's centre, in the site's frame C
};

/// What a mesh in a scene's place is made of: tissue of the solid, of the regions in it by their names, and
/// of a cup's lining.
struct MeshSceneTissue {
  struct Region {
    std::string name;  ///< of the mesh's region, upper and lower case alike; "*": of any
    ShellTissue tissue;
  };
  struct Lining {
    double lining_radii{1.25};
    std::vector<TissueLayer> layers;
    MaterialIndex core{0};
  };
  ShellTissue solid;
  std::vector<Region> regions;  ///< the first that fits counts; a region that none fits is the solid's tissue
  std::optional<Lining> lining;
};

/// What is asked of a scene's model; what it takes is planned (docs/planning.md).
struct FidelityRequest {
  double error_m{0.1e-3};  ///< mean depth that a cut may be off its sweep
  double rate_hz{250.0};   ///< frames a second
};

/// A scene: what to make, of what, and how fine.
struct SceneParams {
  std::string name{"block"};  ///< of a block; the other shapes have their own
  SceneShape shape;
  SiteParams site;
  ZoneParams zone;
  MeshSceneTissue mesh_tissue;
  std::vector<std::string> material_names;  ///< what the indices of shape and mesh tissue stand for
  std::vector<Material> materials;          ///< of these names, in their order
  PackingParams packing;
  std::optional<FidelityRequest> fidelity;  ///< nothing: it is packed as it says
  MassPointParams points;
  SceneEventParams events;
};

/// A solid, and where it is cut.
struct SceneSolid {
  std::string name;
  std::shared_ptr<const Solid> solid;
  Cup site;  ///< in G
};

/// The scene's generated solid. The site's centre is where its line first meets the solid from above.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] SceneSolid MakeSceneSolid(const SceneParams& scene);

/// The solid of a mesh file (see LoadMesh), `scale` millimetres to one of its units, in the scene's place; G
/// is the file's frame, scaled.
///
/// The site must be on the mesh, as a cup or as an entry. A cup: in at least a quarter of the directions into
/// its lower half, bone begins between 70 and 130 % of its radius. An entry: its centre is within a quarter
/// of its radius of the surface, and the surface lies between one radius above and one below it along the
/// axis; on a convex surface only where the zone of the scene is no cup.
/// @param site  in G; its axis need not be of unit length
/// @throws std::invalid_argument as MakeSceneSolid does.
[[nodiscard]] tl::expected<SceneSolid, MeshError> LoadSceneSolid(const std::filesystem::path& path,
                                                                 double scale, const Cup& site,
                                                                 const SceneParams& scene);

/// The same for a mesh that was read before; the file's name stands for it in names and messages. Without a
/// site there is no lining, and nothing that must be on the mesh; the site's radius is then 0.
[[nodiscard]] tl::expected<SceneSolid, MeshError> MakeMeshSolid(const LoadedMesh& loaded,
                                                                const std::filesystem::path& path,
                                                                const std::optional<Cup>& site,
                                                                const SceneParams& scene);

/// @param solid  must outlive the zone
/// @throws std::invalid_argument as the zones do.
[[nodiscard]] std::unique_ptr<CutZone> MakeZone(const ZoneParams& zone, const Cup& site, const Solid& solid);

/// Fills the solid with balls and mass points, as fine as the scene asks.
/// @param split  the engine is going to split balls that a tool touches (SplitParams): then these are the few
///   large ones that SplitPackingFor makes of the scene's packing
/// @throws std::invalid_argument naming the parameter, its value and what is accepted; also where the
/// materials are not those that are named, or the solid takes more than 100 million cells.
[[nodiscard]] Bone PackScene(const SceneSolid& solid, const SceneParams& scene, bool split = false);

/// The scene's bone of balls and mass points that were made otherwise: materials and site are its own.
/// @throws std::invalid_argument where the materials are not those that are named.
[[nodiscard]] Bone SceneBone(const SceneSolid& solid, const SceneParams& scene, std::vector<Ball> balls,
                             std::vector<MassPoint> points);

/// The generated acetabulum by itself.
struct AcetabulumParams {
  AcetabulumShape shape;
  PackingParams packing;
  MassPointParams points;
  std::vector<Material> materials{DefaultBoneMaterials()};  ///< the first three are those of BoneTissue
};

/// Block with a hemispherical cup; G at the cup's centre, +z out of it.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] Bone MakeAcetabulum(const AcetabulumParams& params);

/// A bone with a cup from a mesh.
struct MeshBoneParams {
  MeshTissue tissue;
  PackingParams packing;
  MassPointParams points;
  std::vector<Material> materials{DefaultBoneMaterials()};
};

/// A mesh file in millimetres, packed below its cup; the bone takes the file's name.
/// @throws std::invalid_argument as PackScene does.
[[nodiscard]] tl::expected<Bone, MeshError> MakeBoneFromMesh(const std::filesystem::path& path,
                                                             const Cup& cup, const MeshBoneParams& params);

}  // namespace osteon::simulation
