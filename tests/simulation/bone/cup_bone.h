#pragma once

#include <vector>

#include "simulation/bone/scenes.h"

// Makes a bone with a cup from a mesh file, for the tests of meshes. Its tissues are as thick as those of
// MakeAcetabulum.

namespace osteon::simulation {

/// Thicknesses of the tissues below a bone's surface.
struct MeshTissue {
  double cartilage_m{0.002};    ///< inside the cup
  double subchondral_m{0.001};  ///< cortical plate below the cartilage
  double cortical_m{0.0015};    ///< shell everywhere else; cancellous below
  double lining_radii{1.25};    ///< extent of the cup's lining, in cup radii: see LiningTissue
};

/// Converts the thicknesses to a map of tissues with the materials of BoneTissue.
[[nodiscard]] inline TissueMap CupBoneTissue(const MeshTissue& tissue, const CutSite& cup) {
  return {.shells = {{.layers = {{.material = kCortical, .thickness_m = tissue.cortical_m}},
                      .core = kCancellous,
                      .image = {}}},
          .lining = LiningTissue{.cup = cup,
                                 .lining_radii = tissue.lining_radii,
                                 .layers = {{.material = kCartilage, .thickness_m = tissue.cartilage_m},
                                            {.material = kCortical, .thickness_m = tissue.subchondral_m}},
                                 .core = kCancellous}};
}

/// Reads a mesh file in millimetres and packs it as a cell's scene does, finest near the cup.
[[nodiscard]] inline tl::expected<Bone, MeshError> MakeBoneFromMesh(const std::filesystem::path& path,
                                                                    const CutSite& cup,
                                                                    const MeshTissue& tissue) {
  const TissueMap map = CupBoneTissue(tissue, cup);
  SceneParams scene;
  scene.mesh_tissue = {
      .solid = map.shells.front(),
      .regions = {},
      .lining = MeshSceneTissue::Lining{
          .lining_radii = map.lining->lining_radii, .layers = map.lining->layers, .core = map.lining->core}};
  scene.material_names = MaterialNames(AcetabulumShape{});
  scene.materials = DefaultBoneMaterials();
  scene.materials.resize(scene.material_names.size());
  const auto solid = LoadSceneSolid(path, 1.0, cup, scene);
  if (!solid) return tl::make_unexpected(solid.error());
  return PackScene(*solid, scene);
}

}  // namespace osteon::simulation
