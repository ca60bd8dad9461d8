#pragma once

#include <filesystem>
#include <optional>

#include "config/reading/bone_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Reads the mesh or packing that replaces the scene's generated bone.
/// @param scene  replaced by the section's own scene, if it names one
/// @returns nothing if the section names neither mesh nor packing.
[[nodiscard]] std::optional<BoneConfig> ReadBone(Reader section, std::filesystem::path& scene);

}  // namespace osteon::config
