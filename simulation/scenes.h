#pragma once

#include <filesystem>
#include <memory>

#include "simulation/acetabulum_solid.h"
#include "simulation/mass_points.h"
#include "simulation/mesh_solid.h"
#include "simulation/packing_builder.h"
#include "simulation/scene_events.h"
#include "simulation/triangle_mesh.h"

namespace osteon::simulation {

/// "cartilage", "cortical", "cancellous", in the order of BoneTissue, with where each figure comes from.
[[nodiscard]] std::vector<Material> DefaultBoneMaterials();

/// The generated acetabulum.
struct AcetabulumParams {
  AcetabulumShape shape;
  PackingParams packing;
  MassPointParams points;
  std::vector<Material> materials{DefaultBoneMaterials()};
  SceneEventParams events;
};

/// Block with a hemispherical cup; G at the cup's centre, +z out of it.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] Bone MakeAcetabulum(const AcetabulumParams& params);

/// A bone from a mesh.
struct MeshBoneParams {
  MeshTissue tissue;
  PackingParams packing;
  MassPointParams points;
  std::vector<Material> materials{DefaultBoneMaterials()};
};

/// The solid that a mesh file bounds (see LoadMesh); G is the file's frame. `cup` says where it is to be
/// reamed; its axis need not be of unit length. In at least a quarter of the directions into the cup's lower
/// half, bone must begin within 30 % of its radius.
/// @throws std::invalid_argument as MakeAcetabulum does.
[[nodiscard]] tl::expected<std::shared_ptr<const MeshSolid>, MeshError> LoadMeshSolid(
    const std::filesystem::path& path, const Cup& cup, const MeshTissue& tissue);

/// Packs the solid of a mesh file; the bone takes the file's name.
/// @throws std::invalid_argument as MakeAcetabulum does, and where the solid takes more than 20 million
/// cells.
[[nodiscard]] Bone PackMeshBone(const std::filesystem::path& path, const MeshSolid& solid,
                                const MeshBoneParams& params);

/// Both in one.
[[nodiscard]] tl::expected<Bone, MeshError> MakeBoneFromMesh(const std::filesystem::path& path,
                                                             const Cup& cup, const MeshBoneParams& params);

}  // namespace osteon::simulation
