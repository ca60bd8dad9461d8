#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

// Readers from mesh files to triangles, one for each format. Each reader checks and reads in the same pass,
// so that no unchecked data are used.

namespace osteon::simulation {

/// The triangles of a file, in the file's order and unit. Polygons are cut into triangles.
struct RawMesh {
  std::vector<std::string> parts;  ///< names of groups, objects or solids that have triangles, in UTF-8
  std::vector<std::array<std::array<float, 3>, 3>> triangles;
  std::vector<std::uint32_t> part_of_triangle;
};

/// Reads an STL, OBJ or PLY file by its extension.
/// @returns at least one triangle, all coordinates finite; or an error: no such file, another format, or the
///   line or byte at which the file is damaged.
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadMeshFile(const std::filesystem::path& path);

/// The readers, one for each format. `content` holds all bytes of a file, valid or not; error messages call
/// the file `name`.
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadStl(std::string_view content, const std::string& name);
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadObj(std::string_view content, const std::string& name);
[[nodiscard]] tl::expected<RawMesh, MeshError> ReadPly(std::string_view content, const std::string& name);

}  // namespace osteon::simulation
