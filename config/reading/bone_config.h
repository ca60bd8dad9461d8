#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "simulation/bone/scenes.h"

namespace osteon::config {

/// A mesh or a packing that replaces the scene's generated solid.
struct BoneConfig {
  std::filesystem::path file;  ///< a closed mesh, or a packing (.osp)
  /// The site, in the file's frame after scaling. Absent: the packing file contains its site.
  std::optional<simulation::CutSite> cup{};
  double scale{1.0};    ///< length of the mesh's unit [mm]
  std::string place{};  ///< where the cell names cup or file, "my.yaml:12": for errors of the mesh
};

}  // namespace osteon::config
