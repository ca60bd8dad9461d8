#include "session/setup/cell_bone.h"

#include <utility>

#include <fmt/format.h>

#include "simulation/packing/packing_file.h"
#include "simulation/solids/cup_frame.h"

namespace osteon::session {
namespace {

// Loads a bone that `osteon pack` has saved. It is an error if the bone has no site to cut, or no mass
// points.
tl::expected<simulation::Bone, std::string> LoadPacking(const MeshChoice& choice) {
  const auto file = simulation::PackingFile::Open(choice.file);
  if (!file) return tl::make_unexpected(file.error().Text());
  const auto refuse = [&](const char* found, const char* accepted) {
    return tl::make_unexpected(
        fmt::format("{}: found a packing without {}, accepted {}", choice.file.string(), found, accepted));
  };
  if (!file->site() && !choice.cup) return refuse("a site", "one with it, or --cup");
  if (file->points().empty()) return refuse("mass points", "one with them (osteon pack without --no-points)");
  simulation::Bone bone = file->ToBone();
  if (choice.cup) bone.site = *choice.cup;
  return bone;
}

}  // namespace

tl::expected<void, std::string> MakeCellBone(CellSetup& setup,
                                             const std::optional<MeshChoice>& mesh_instead) {
  const simulation::SceneParams& scene = setup.config.scene;
  std::optional<MeshChoice> mesh = mesh_instead;
  std::string place;  // place in the cell's file that names the bone, for messages; empty: it names none
  if (!mesh && setup.config.bone) {
    place = setup.config.bone->place + ": ";
    mesh = {
        .file = setup.config.bone->file, .cup = setup.config.bone->cup, .scale = setup.config.bone->scale};
  }
  if (mesh && mesh->file.extension() == ".osp") {
    auto bone = LoadPacking(*mesh);
    if (!bone) return tl::make_unexpected(place + bone.error());
    setup.bone = std::move(*bone);
  } else {
    simulation::SceneSolid made;
    if (!mesh) {
      made = simulation::MakeSceneSolid(scene);
    } else {
      auto loaded = simulation::LoadSceneSolid(mesh->file, mesh->scale,
                                               mesh->cup.value_or(simulation::CutSite{}), scene);
      if (!loaded) return tl::make_unexpected(place + loaded.error().message);
      made = std::move(*loaded);
    }
    setup.bone.name = made.name;
    setup.bone.site = made.site;
    setup.bone_warning = made.warning;
    setup.solid = made.solid;
  }
  // place the bone so that its site is at the configured place: the configuration's X_WG is the pose of the
  // site's frame C
  setup.X_WG = setup.config.X_WG * simulation::CupPose(setup.bone.site).inverse();
  return {};
}

}  // namespace osteon::session
