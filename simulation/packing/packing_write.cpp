#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/output_file.h"
#include "base/parallel.h"
#include "simulation/packing/packing_file.h"
#include "simulation/packing/packing_layout.h"
#include "simulation/packing/packing_text.h"

namespace osteon::simulation {

using namespace packing_layout;

namespace {

/// Largest accepted coordinate in G. Multiples of the grid up to this value are exact in double precision.
constexpr double kFarthest_mm = 1e6;

/// Largest rounding error, in grid steps, of a multiple of the grid after its conversion to metres and back
/// in double precision. 1e6 mm is 2^35 grid steps, and a double has 53 bits.
constexpr double kRounding_grids = 1e-4;

/// Rounds a length to a whole number of grid steps.
double ToGrid(double length_m) { return std::nearbyint(length_m * 1e3 / kGrid_mm); }

/// Converts a multiple of the grid to millimetres from the origin. Minus zero becomes zero: its sign would be
/// lost when the file is loaded and saved again.
float MmFromOrigin(double grids, double origin_mm) {
  return static_cast<float>(grids * kGrid_mm - origin_mm + 0.0);
}

/// Converts a bone to the sections of a packing file, checks it, and writes the file.
class PackingWriter {
 public:
  PackingWriter(const std::filesystem::path& path, const Bone& bone, const PackingProvenance& provenance)
      : path_(path), bone_(bone), provenance_(provenance) {}

  tl::expected<void, FileError> Write() {
    if (bone_.balls.empty()) Fail("balls", "none", "1 and more");
    ChooseOrigin();
    if (!error_) PackBalls();
    if (!error_) PackPoints();
    if (!error_) PackSite();
    const auto materials = MaterialsToText(bone_.materials);
    if (!materials) FailText("materials", materials.error());
    const auto provenance = ProvenanceToText({.name = bone_.name, .provenance = provenance_});
    if (!provenance) FailText("provenance", provenance.error());
    for (const auto* text : {&materials, &provenance})
      if (*text && (*text)->size() > kMaxTextBytes)
        Fail(text == &materials ? "materials" : "provenance", fmt::format("{} bytes", (*text)->size()),
             fmt::format("up to {}", kMaxTextBytes));
    if (error_) return tl::make_unexpected(*error_);

    AddSection(kBalls, std::as_bytes(std::span(balls_)), balls_.size());
    AddSection(kPoints, std::as_bytes(std::span(points_)), points_.size());
    AddSection(kPointMaterials, std::as_bytes(std::span(point_materials_)), point_materials_.size());
    AddSection(kMaterials, std::as_bytes(std::span(*materials)), materials->size());
    if (bone_.site.radius_m != 0.0) AddSection(kSite, std::as_bytes(std::span(&site_, 1)), 1);
    AddSection(kProvenance, std::as_bytes(std::span(*provenance)), provenance->size());
    return WriteSections();
  }

 private:
  struct Section {
    SectionEntry entry;
    std::span<const std::byte> bytes;
  };

  void Fail(const std::string& where, const std::string& found, const std::string& accepted) {
    if (!error_)
      error_ = FileError{.file = path_.string(),
                         .byte = {},
                         .where = "cannot be written: " + where,
                         .found = found,
                         .accepted = accepted};
  }
  void FailText(const std::string& section, const TextError& error) {
    Fail(section + (error.where.empty() ? "" : ": " + error.where), error.found, error.accepted);
  }

  /// Chooses the origin: the middle of all balls and points, on the grid and rounded to whole millimetres.
  /// Positions are rounded to the grid first, so that a reloaded packing gets the same origin.
  void ChooseOrigin() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::array<double, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
    const auto extend = [&](const Vector3& p, const char* what, std::size_t i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(std::abs(p[k]) * 1e3 <= kFarthest_mm))
          return Fail(fmt::format("{} {}: {}", what, i, "xyz"[k]), fmt::format("{} mm", p[k] * 1e3),
                      fmt::format("-{0} … {0} mm", kFarthest_mm));
        const double grids = ToGrid(p[k]);
        low[k] = std::min(low[k], grids);
        high[k] = std::max(high[k], grids);
      }
    };
    for (std::size_t i = 0; i < bone_.balls.size() && !error_; ++i)
      extend(bone_.balls[i].center_m, "ball", i);
    for (std::size_t i = 0; i < bone_.points.size() && !error_; ++i)
      extend(bone_.points[i].p_m, "mass point", i);
    for (std::size_t k = 0; k < 3 && !error_; ++k) {
      origin_mm_[k] = std::floor(0.5 * (low[k] + high[k]) * kGrid_mm + 0.5);
      const double reach = std::max(high[k] * kGrid_mm - origin_mm_[k], origin_mm_[k] - low[k] * kGrid_mm);
      if (reach > double{kReach_mm})
        Fail(fmt::format("size along {}", "xyz"[k]), fmt::format("{:.6g} mm", (high[k] - low[k]) * kGrid_mm),
             fmt::format("up to {} mm", 2 * kReach_mm));
    }
  }

  void PackBalls() {
    balls_.resize(bone_.balls.size());
    ParallelFor(
        balls_.size(), 0,
        [this](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            const Ball& ball = bone_.balls[i];
            const Vector3 p = ball.center_m;
            const Vector3 grids(ToGrid(p.x()), ToGrid(p.y()), ToGrid(p.z()));
            // Reduce the radius by the centre's shift, so that the saved ball lies within the given ball.
            // kRounding_grids keeps a radius on the grid from losing a grid step by rounding.
            const double moved = (grids - p * (1e3 / kGrid_mm)).norm();
            const double radius = std::floor(ball.radius_m * 1e3 / kGrid_mm - moved + 2.0 * kRounding_grids);
            balls_[i] = {.x_mm = MmFromOrigin(grids.x(), origin_mm_[0]),
                         .y_mm = MmFromOrigin(grids.y(), origin_mm_[1]),
                         .z_mm = MmFromOrigin(grids.z(), origin_mm_[2]),
                         .radius_mm = static_cast<float>(radius * kGrid_mm)};
          }
        },
        std::size_t{1} << 14);
    for (std::size_t i = 0; i < balls_.size(); ++i)
      if (!(balls_[i].radius_mm > 0.0f && balls_[i].radius_mm <= kReach_mm))
        return Fail(fmt::format("ball {}: radius", i), fmt::format("{} mm", bone_.balls[i].radius_m * 1e3),
                    fmt::format("{} … {} mm", 2 * kGrid_mm, kReach_mm));
  }

  void PackPoints() {
    for (std::size_t i = 0; i < bone_.points.size(); ++i) {
      const MassPoint& point = bone_.points[i];
      const Vector3 p = point.p_m;
      const auto volume_mm3 = static_cast<float>(point.volume_m3 * 1e9);
      if (!(volume_mm3 > 0.0f && volume_mm3 <= kMaxVolume_mm3))
        return Fail(fmt::format("mass point {}: volume", i), fmt::format("{} mm^3", point.volume_m3 * 1e9),
                    fmt::format("above 0, up to {} mm^3", kMaxVolume_mm3));
      if (point.material >= bone_.materials.size())
        return Fail(fmt::format("mass point {}: material", i), fmt::format("{}", point.material),
                    fmt::format("less than {}: so many are listed", bone_.materials.size()));
      points_.push_back({.x_mm = MmFromOrigin(ToGrid(p.x()), origin_mm_[0]),
                         .y_mm = MmFromOrigin(ToGrid(p.y()), origin_mm_[1]),
                         .z_mm = MmFromOrigin(ToGrid(p.z()), origin_mm_[2]),
                         .volume_mm3 = volume_mm3});
      point_materials_.push_back(point.material);
    }
  }

  void PackSite() {
    const CutSite& site = bone_.site;
    if (site.radius_m == 0.0) return;
    const Vector3 axis = site.axis;
    if (!(site.radius_m > 0.0 && site.radius_m <= 1.0))
      Fail("site: radius", fmt::format("{} m", site.radius_m), "0 (no site), or up to 1 m");
    if (!(std::abs(axis.norm() - 1.0) <= 1e-6))
      Fail("site: axis", fmt::format("({}, {}, {})", axis.x(), axis.y(), axis.z()), "a length of 1");
    if (!(Vector3(site.center_m).cwiseAbs().maxCoeff() <= 1e3) || !Vector3(site.center_m).allFinite())
      Fail("site: centre", fmt::format("({}, {}, {}) m", site.center_m.x, site.center_m.y, site.center_m.z),
           "within ±1000 m");
    site_ = {.center_m = {site.center_m.x, site.center_m.y, site.center_m.z},
             .axis = {axis.x(), axis.y(), axis.z()},
             .radius_m = site.radius_m};
  }

  /// Appends a section unless it is empty; WriteSections sets its offset.
  void AddSection(SectionKind kind, std::span<const std::byte> bytes, std::size_t count) {
    if (count == 0) return;
    const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    sections_.push_back({.entry = {.kind = kind,
                                   .crc = static_cast<std::uint32_t>(crc),
                                   .offset = 0,
                                   .bytes = bytes.size(),
                                   .count = count},
                         .bytes = bytes});
  }

  tl::expected<void, FileError> WriteSections() {
    std::uint64_t end = sizeof(FileHeader) + sections_.size() * sizeof(SectionEntry);
    std::vector<SectionEntry> table;
    for (Section& section : sections_) {
      section.entry.offset = (end + kAlignment - 1) / kAlignment * kAlignment;
      end = section.entry.offset + section.entry.bytes;
      table.push_back(section.entry);
    }
    FileHeader header{
        .file_bytes = end, .sections = static_cast<std::uint32_t>(sections_.size()), .origin_mm = origin_mm_};
    const auto table_bytes = std::as_bytes(std::span(table));
    uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(&header), offsetof(FileHeader, crc));
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(table_bytes.data()), table_bytes.size());
    header.crc = static_cast<std::uint32_t>(crc);

    auto file = OutputFile::Create(path_);
    if (!file) return tl::make_unexpected(file.error());
    file->Write(std::as_bytes(std::span(&header, 1)));
    file->Write(table_bytes);
    static constexpr std::array<std::byte, kAlignment> kZeros{};
    std::uint64_t at = sizeof(FileHeader) + table_bytes.size();
    for (const Section& section : sections_) {
      file->Write(std::span(kZeros).first(section.entry.offset - at));
      file->Write(section.bytes);
      at = section.entry.offset + section.entry.bytes;
    }
    return file->Commit();
  }

  std::filesystem::path path_;
  const Bone& bone_;
  const PackingProvenance& provenance_;
  std::array<double, 3> origin_mm_{};
  std::vector<PackedBall> balls_;
  std::vector<PackedPoint> points_;
  std::vector<MaterialIndex> point_materials_;
  PackedSite site_;
  std::vector<Section> sections_;
  std::optional<FileError> error_;
};

}  // namespace

tl::expected<void, FileError> WritePackingFile(const std::filesystem::path& path, const Bone& bone,
                                               const PackingProvenance& provenance) {
  return PackingWriter(path, bone, provenance).Write();
}

}  // namespace osteon::simulation
