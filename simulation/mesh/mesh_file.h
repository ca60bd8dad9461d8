#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

// How a mesh file becomes triangles. One reader a format checks and reads in the same pass: what it accepts
// is what is used, so nothing that it saw can be lost or read differently behind it.

namespace osteon::simulation {

/// A file's triangles as they stand in it, in its own unit; polygons are cut into triangles.
struct RawMesh {
  std::vector<std::string> parts;  ///< names of its groups, objects or solids: UTF-8, those with triangles
  std::vector<std::array<std::array<float, 3>, 3>> triangles;
  std::vector<std::uint32_t> part_of_triangle;
};

/// Reads an STL, OBJ or PLY file by its extension.
/// @returns the triangles, at least one, all coordinates finite; or why not: no such file, another format,
///   or the line or byte where it is damaged.
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadMeshFile(const std::filesystem::path& path);

/// The readers, one a format. `content` is a whole file of any bytes, `name` what messages call it.
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadStl(std::string_view content, const std::string& name);
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadObj(std::string_view content, const std::string& name);
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadPly(std::string_view content, const std::string& name);

}  // namespace osteon::simulation
