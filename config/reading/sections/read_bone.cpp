#include "config/reading/sections/read_bone.h"

namespace osteon::config {

std::optional<BoneConfig> ReadBone(Reader section, std::filesystem::path& scene) {
  if (section.Has("scene")) scene = section.File("scene", "scenes");
  const bool has_mesh = section.Has("mesh");
  if (!has_mesh && !section.Has("packing")) return std::nullopt;
  BoneConfig bone;
  if (has_mesh && section.Has("packing"))
    section.Refuse("packing", "found beside mesh, accepted one of the two");
  bone.file = section.File(has_mesh ? "mesh" : "packing");
  bone.place = section.PlaceOf(section.Has("cup") ? "cup" : has_mesh ? "mesh" : "packing");
  if (has_mesh && section.Has("scale_ratio")) bone.scale = section.Number("scale_ratio", 1e-4, 1e4);
  if (has_mesh && !section.Has("cup"))
    section.Refuse("mesh",
                   "found no cup beside it, accepted cup: {center_mm: [x, y, z], outward_axis: [x, y, z], "
                   "radius_mm: R}, in the mesh's own frame (docs/cell_files.md)");
  if (has_mesh || section.Has("cup")) {
    Reader cup = section.Section("cup");
    bone.cup = simulation::CutSite{.center_m = cup.Triple("center_mm", -2000, 2000),
                                   .axis = cup.Direction("outward_axis"),
                                   .radius_m = cup.Number("radius_mm", 0.5, 60)};
  }
  return bone;
}

}  // namespace osteon::config
