#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "base/mapped_file.h"
#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// A ball in the file: float32 millimetres relative to the file's origin.
struct PackedBall {
  float x_mm{0.0f}, y_mm{0.0f}, z_mm{0.0f}, radius_mm{0.0f};
};

/// A mass point in the file; its material is in a separate list.
struct PackedPoint {
  float x_mm{0.0f}, y_mm{0.0f}, z_mm{0.0f}, volume_mm3{0.0f};
};

/// Provenance of a packing: all inputs that determine it. Other facts (threads, time, folder) are left out,
/// so that equal packings give equal files.
struct PackingProvenance {
  std::string program{};                      ///< name and version
  std::string source{};                       ///< file name of the mesh, or the shape
  std::optional<std::uint32_t> source_crc{};  ///< CRC-32 of the mesh file
  /// Key ([a-z0-9_], with its unit at the end) and value of each parameter, in the given order.
  std::vector<std::pair<std::string, std::string>> parameters{};

  bool operator==(const PackingProvenance&) const = default;
};

/// Saves a bone (packing_layout.h; docs/packing.md). The file appears complete or not at all. Each saved ball
/// lies within the given ball, so rounding adds no protrusion and no overlap. A site of radius 0 means that
/// there is no site; it is not saved. The bytes depend on the arguments alone. If a loaded bone is saved
/// again, the file has the same bytes.
/// @returns an error if a value cannot be stored: no ball, a coordinate farther than 512 mm from the middle,
///   a radius that is not positive, an unlisted material, no or more than 8 materials; or if the system
///   refuses to write.
[[nodiscard]] tl::expected<void, FileError> WritePackingFile(const std::filesystem::path& path,
                                                             const Bone& bone,
                                                             const PackingProvenance& provenance);

/// A packing file, mapped into memory and verified. Its views point into the mapping, and are valid as long
/// as this object lives.
class PackingFile {
 public:
  /// Opens a file and verifies everything before use: sizes, sections, checksums, values. Allocates at most
  /// in proportion to the file's size. Threads 0: one per core.
  [[nodiscard]] static tl::expected<PackingFile, FileError> Open(const std::filesystem::path& path,
                                                                 int threads = 0);

  /// Origin of balls and points, in G.
  [[nodiscard]] Vector3 origin_mm() const { return origin_mm_; }
  [[nodiscard]] std::span<const PackedBall> balls() const { return balls_; }
  [[nodiscard]] std::span<const PackedPoint> points() const { return points_; }
  [[nodiscard]] const std::vector<Material>& materials() const { return materials_; }
  /// The site at which the bone is to be cut; absent if the packing was made for no particular site.
  [[nodiscard]] const std::optional<CutSite>& site() const { return site_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const PackingProvenance& provenance() const { return provenance_; }

  /// A copy in doubles and metres. Without a site, the radius of the bone's site is 0.
  [[nodiscard]] Bone ToBone() const;

 private:
  friend class PackingReader;
  PackingFile() = default;

  MappedFile file_;
  Vector3 origin_mm_{Vector3::Zero()};
  std::span<const PackedBall> balls_;
  std::span<const PackedPoint> points_;
  std::span<const MaterialIndex> point_materials_;
  std::vector<Material> materials_;
  std::optional<CutSite> site_;
  std::string name_;
  PackingProvenance provenance_;
};

}  // namespace osteon::simulation
