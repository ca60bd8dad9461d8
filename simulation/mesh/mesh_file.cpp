#include "simulation/mesh/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

namespace osteon::simulation {
namespace {

constexpr std::uintmax_t kLargestFile = 1'500'000'000;  // bytes; 30 million triangles of a binary STL

tl::unexpected<MeshError> Refuse(MeshErrorKind kind, std::string message) {
  return tl::make_unexpected(MeshError{.kind = kind, .message = std::move(message)});
}

/// The name that a group or object has in the file: a mesh's own, or that of the node it hangs from.
void NameParts(const aiNode& node, std::vector<std::string>& names) {
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    std::string& name = names[node.mMeshes[i]];
    if (name.empty()) name = node.mName.C_Str();
    if (name == "defaultobject") name.clear();  // assimp's own, where an OBJ names none
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) NameParts(*node.mChildren[i], names);
}

}  // namespace

tl::expected<RawMesh, MeshError> ReadMeshFile(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".stl" && extension != ".obj" && extension != ".ply")
    return Refuse(MeshErrorKind::kFormat,
                  fmt::format("{}: found extension '{}', accepted .stl, .obj, .ply", name, extension));
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return Refuse(MeshErrorKind::kMissing, fmt::format("{}: found a folder, accepted a file", name));
  if (!std::filesystem::is_regular_file(path, error))
    return Refuse(MeshErrorKind::kMissing, fmt::format("{}: no such file", name));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > kLargestFile)
    return Refuse(MeshErrorKind::kUnreadable,
                  fmt::format("{}: found {} bytes, accepted up to {}", name, size, kLargestFile));
  if (size == 0)
    return Refuse(MeshErrorKind::kEmpty,
                  fmt::format("{}: found an empty file, accepted a closed surface", name));

  std::string content(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(content.data(), static_cast<std::streamsize>(size)))
    return Refuse(MeshErrorKind::kUnreadable, fmt::format("{}: cannot be read (permissions?)", name));
  const auto damage = extension == ".stl"   ? FindStlDamage(content, name)
                      : extension == ".obj" ? FindObjDamage(content, name)
                                            : FindPlyDamage(content, name);
  if (damage) return tl::make_unexpected(*damage);
  content = std::string();

  Assimp::Importer importer;
  const aiScene* scene = nullptr;
  std::string why;
  try {
    scene = importer.ReadFile(name, aiProcess_Triangulate);
    why = importer.GetErrorString();
  } catch (const std::exception& e) {
    why = e.what();
  }
  if (!scene) {
    why.erase(why.find_last_not_of(" \n\r") + 1);
    return Refuse(MeshErrorKind::kUnreadable,
                  fmt::format("{}: cannot be read as {}: {}", name, extension.substr(1), why));
  }

  std::vector<std::string> names(scene->mNumMeshes);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) names[m] = scene->mMeshes[m]->mName.C_Str();
  if (scene->mRootNode) NameParts(*scene->mRootNode, names);
  RawMesh raw;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    // assimp makes a mesh of each material: parts of one name are one
    const auto known = std::find(raw.parts.begin(), raw.parts.end(), names[m]);
    const auto place = static_cast<std::uint32_t>(known - raw.parts.begin());
    if (known == raw.parts.end()) raw.parts.push_back(names[m]);
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines bound nothing
      std::array<std::array<float, 3>, 3> triangle{};
      for (int k = 0; k < 3; ++k) {
        const aiVector3D& v = part.mVertices[face.mIndices[k]];
        // adding zero turns -0 into +0, which are the same place
        triangle[k] = {v.x + 0.0f, v.y + 0.0f, v.z + 0.0f};
      }
      raw.triangles.push_back(triangle);
      raw.part_of_triangle.push_back(place);
    }
  }
  return raw;
}

}  // namespace osteon::simulation
