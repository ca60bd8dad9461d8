#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

// How a mesh file becomes triangles: a first reading of ours that finds what is wrong and where, then
// assimp's. Damaged files have made assimp hang: it is given sound ones only.

namespace osteon::simulation {

/// A file's triangles as they stand in it, in its own unit; polygons are cut into triangles.
struct RawMesh {
  std::vector<std::string> parts;  ///< names of its groups, objects or solids
  std::vector<std::array<std::array<float, 3>, 3>> triangles;
  std::vector<std::uint32_t> part_of_triangle;
};

/// @returns why not: no such file, another format, or the line or byte where it is damaged.
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadMeshFile(const std::filesystem::path& path);

/// The first readings, one a format: what is wrong in `content` and where, if anything is. `name` is the
/// file's.
[[nodiscard]] std::optional<MeshError> FindStlDamage(std::string_view content, const std::string& name);
[[nodiscard]] std::optional<MeshError> FindObjDamage(std::string_view content, const std::string& name);
[[nodiscard]] std::optional<MeshError> FindPlyDamage(std::string_view content, const std::string& name);

}  // namespace osteon::simulation
