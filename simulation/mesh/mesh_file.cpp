#include "simulation/mesh/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

#include <fmt/format.h>

#include "base/no_file_text.h"
#include "simulation/mesh/mesh_text.h"

namespace osteon::simulation {
namespace {

constexpr std::uintmax_t kMaxFile = 1'500'000'000;  // bytes; 30 million triangles of a binary STL

tl::unexpected<MeshError> Refuse(MeshErrorKind kind, std::string message) {
  return tl::make_unexpected(MeshError{.kind = kind, .message = std::move(message)});
}

/// First bytes by which a kind of file is recognised, and the name of this kind in messages.
struct Signature {
  std::string_view bytes;
  const char* what;
};

using namespace std::string_view_literals;

/// Kinds of files that are no meshes, but may carry a mesh file's extension by mistake.
constexpr std::array<Signature, 20> kSignatures{{
    {"version https://git-lfs", "a pointer of git LFS, not the mesh (git lfs pull fetches it)"},
    {"PK\x03\x04"sv, "a ZIP archive (3MF files and packed exports are such)"},
    {"PK\x05\x06"sv, "an empty ZIP archive"},
    {"\x1f\x8b"sv, "a gzip file"},
    {"BZh", "a bzip2 file"},
    {"\xfd"
     "7zXZ"sv,
     "an xz file"},
    {"\x28\xb5\x2f\xfd"sv, "a Zstandard file"},
    {"7z\xbc\xaf\x27\x1c"sv, "a 7z archive"},
    {"Rar!\x1a"sv, "a RAR archive"},
    {"\xff\xfe"sv, "text in UTF-16"},
    {"\xfe\xff"sv, "text in UTF-16"},
    {"glTF", "a glTF file"},
    {"# vtk DataFile", "a VTK file"},
    {"NRRD", "an NRRD volume"},
    {"ISO-10303-21", "a STEP file"},
    {"OFF", "an OFF file"},
    {"%PDF", "a PDF file"},
    {"<!", "a web page or XML"},
    {"<", "XML or a web page"},
    {"{", "JSON"},
}};

/// Names the kind of a file whose content contradicts its extension; empty if the file may be a mesh.
std::string_view FindOtherKind(std::string_view content, const std::string& extension) {
  const std::string_view text =
      content.substr(content.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  for (const Signature& signature : kSignatures)
    if (text.starts_with(signature.bytes)) return signature.what;
  if (content.size() > 132 && content.substr(128, 4) == "DICM") return "a DICOM file";
  if (extension != ".ply" && (text.starts_with("ply\n") || text.starts_with("ply\r"))) return "a PLY file";
  if (extension != ".stl" && text.starts_with("solid") &&
      text.substr(0, 4096).find("facet") != std::string_view::npos)
    return "an STL file";
  return {};
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
  if (const std::string wrong = base::NoFileText(path); !wrong.empty())
    return Refuse(MeshErrorKind::kMissing, fmt::format("{}: {}", name, wrong));
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > kMaxFile)
    return Refuse(MeshErrorKind::kUnreadable,
                  fmt::format("{}: found {} bytes, accepted up to {}", name, size, kMaxFile));
  if (size == 0)
    return Refuse(MeshErrorKind::kEmpty,
                  fmt::format("{}: found an empty file, accepted a closed surface", name));

  std::string content(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(content.data(), static_cast<std::streamsize>(size)))
    return Refuse(MeshErrorKind::kUnreadable, fmt::format("{}: cannot be read (permissions?)", name));

  auto raw = extension == ".stl"   ? ReadStl(content, name)
             : extension == ".obj" ? ReadObj(content, name)
                                   : ReadPly(content, name);
  // A file that was read as a mesh is accepted whatever its first bytes: a binary STL's header may begin with
  // any bytes.
  if (raw) return raw;
  if (const std::string_view other = FindOtherKind(content, extension); !other.empty())
    return Refuse(MeshErrorKind::kFormat,
                  fmt::format("{}: found {}, accepted {} as its extension says", name, other,
                              extension == ".stl"   ? "an STL file"
                              : extension == ".obj" ? "an OBJ file"
                                                    : "a PLY file"));
  return raw;
}

}  // namespace osteon::simulation
