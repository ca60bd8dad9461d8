#include "simulation/triangle_mesh.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <unordered_map>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include "simulation/check_range.h"

namespace osteon::simulation {
namespace {

struct PlaceHash {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::size_t hash = 0;
    for (const float x : p) hash = hash * 1000003 + std::hash<float>{}(x);
    return hash;
  }
};

tl::unexpected<MeshError> Refuse(MeshErrorKind kind, std::string message) {
  return tl::make_unexpected(MeshError{.kind = kind, .message = std::move(message)});
}

// A PLY header is a few hundred bytes; comments may make it longer.
constexpr std::size_t kPlyHeader = 65536;

bool HasPlyHeader(const std::filesystem::path& path) {
  std::string head(kPlyHeader, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head.starts_with("ply") && head.find("\nend_header") != std::string::npos;
}

}  // namespace

tl::expected<LoadedMesh, MeshError> LoadMesh(const std::filesystem::path& path, const MeshParams& params) {
  if (!(params.scale >= 1e-6 && params.scale <= 1e6))
    throw std::invalid_argument(fmt::format("mesh: scale: found {:g}, accepted 1e-6 … 1e6", params.scale));
  CheckRangeMm("mesh: weld tolerance", params.weld_tolerance_m, 0.0, 1e-4);
  const std::string name = path.string();
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".stl" && extension != ".obj" && extension != ".ply")
    return Refuse(MeshErrorKind::kFormat,
                  fmt::format("{}: found extension '{}', accepted .stl, .obj, .ply", name, extension));
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    return Refuse(MeshErrorKind::kMissing, fmt::format("{}: no such file", name));

  if (extension == ".ply" && !HasPlyHeader(path))  // without its end assimp's parser never ends either
    return Refuse(
        MeshErrorKind::kUnreadable,
        fmt::format("{}: cannot be read as ply: found no complete header in the first {} bytes, accepted "
                    "\"ply\" … \"end_header\"",
                    name, kPlyHeader));

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
  if (!scene) {
    std::string why = importer.GetErrorString();
    why.erase(why.find_last_not_of(" \n\r") + 1);
    return Refuse(MeshErrorKind::kUnreadable,
                  fmt::format("{}: cannot be read as {}: {}", name, extension.substr(1), why));
  }

  LoadedMesh loaded;
  TriangleMesh& mesh = loaded.mesh;
  std::unordered_map<std::array<float, 3>, std::uint32_t, PlaceHash> welded;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines bound nothing
      std::array<std::uint32_t, 3> triangle{};
      for (int k = 0; k < 3; ++k) {
        const aiVector3D& v = part.mVertices[face.mIndices[k]];
        // adding zero turns -0 into +0, which are the same place
        const std::array<float, 3> place{v.x + 0.0f, v.y + 0.0f, v.z + 0.0f};
        const auto [at, is_new] =
            welded.try_emplace(place, static_cast<std::uint32_t>(mesh.vertices_m.size()));
        if (is_new) mesh.vertices_m.push_back(Vector3(v.x, v.y, v.z) * (1e-3 * params.scale));
        triangle[k] = at->second;
      }
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
        ++loaded.report.dropped_triangles;
      else
        mesh.triangles.push_back(triangle);
    }
  }
  const auto checked = CheckMesh(mesh, name);
  if (!checked) return tl::make_unexpected(checked.error());
  loaded.report.flipped = checked->flipped;
  loaded.report.shells = checked->shells;
  return loaded;
}

}  // namespace osteon::simulation
