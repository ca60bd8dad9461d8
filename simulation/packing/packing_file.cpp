#include "simulation/packing/packing_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "base/parallel.h"
#include "simulation/packing/packing_layout.h"
#include "simulation/packing/packing_text.h"

namespace osteon::simulation {

using namespace packing_layout;

namespace {

/// Properties of one kind of section: its name and the limits of its records.
struct KindInfo {
  std::uint32_t kind;
  const char* name;
  std::size_t record_bytes;
  std::size_t max_records;
  bool required;
};
constexpr std::size_t kAnyNumber = SIZE_MAX;
constexpr std::array<KindInfo, 6> kKinds{{
    {kBalls, "balls", sizeof(PackedBall), kAnyNumber, true},
    {kPoints, "mass points", sizeof(PackedPoint), kAnyNumber, false},
    {kPointMaterials, "materials of the points", sizeof(MaterialIndex), kAnyNumber, false},
    {kMaterials, "materials", 1, kMaxTextBytes, true},
    {kSite, "site", sizeof(PackedSite), 1, false},
    {kProvenance, "provenance", 1, kMaxTextBytes, true},
}};

/// Continues the CRC-32 `crc` over more bytes; pass 0 in the first call.
std::uint32_t Crc(std::uint32_t crc, const void* data, std::size_t bytes) {
  return static_cast<std::uint32_t>(crc32_z(crc, static_cast<const Bytef*>(data), bytes));
}

/// The bytes as in "89 4f 53".
std::string Hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes)
    text += fmt::format("{}{:02x}", text.empty() ? "" : " ", std::to_integer<int>(b));
  return text;
}

/// Guesses the kind of a file that is no packing from its first bytes: " (a PNG picture)"; empty if unknown.
std::string GuessFileKind(std::span<const std::byte> bytes) {
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 16));
  struct Known {
    std::string_view start;
    const char* what;
  };
  static constexpr std::array<Known, 8> kKnown{
      {{"\x89PNG", "a PNG picture"},
       {"solid", "an STL mesh as text"},
       {"ply\n", "a PLY file"},
       {"ply\r", "a PLY file"},
       {"\x89MCAP", "a recording"},
       {"\x1f\x8b", "a gzip archive"},
       {"PK\x03\x04", "a zip archive"},
       {"\x89OSP", "a packing changed on its way, as by a transfer in text mode"}}};
  for (const Known& known : kKnown)
    if (start.starts_with(known.start)) return fmt::format(" ({})", known.what);
  return "";
}

}  // namespace

/// Reads a packing file from the header to the contents. Every value is checked before it is used.
class PackingReader {
 public:
  PackingReader(MappedFile file, const std::filesystem::path& path, int threads)
      : path_(path.string()), threads_(threads) {
    packing_.file_ = std::move(file);
    bytes_ = packing_.file_.bytes();
  }

  tl::expected<PackingFile, FileError> Read() {
    ReadHeader();
    if (!error_) ReadTable();
    if (!error_) CheckContents();
    for (const SectionEntry& entry : table_)
      if (!error_) ReadSection(entry);
    if (error_) return tl::make_unexpected(std::move(*error_));
    return std::move(packing_);
  }

 private:
  /// Stores the error, unless there is an earlier one.
  void Fail(std::optional<std::uint64_t> byte, const std::string& where, const std::string& found,
            const std::string& accepted) {
    if (!error_)
      error_ = FileError{.file = path_, .byte = byte, .where = where, .found = found, .accepted = accepted};
  }

  void ReadHeader() {
    const std::string accepted_magic =
        "a packing file, which begins " + Hex(std::as_bytes(std::span(kMagic)));
    if (bytes_.empty()) return Fail({}, "", "an empty file", "a packing file");
    const std::size_t magic_bytes = std::min(bytes_.size(), kMagic.size());
    if (std::memcmp(bytes_.data(), kMagic.data(), magic_bytes) != 0)
      return Fail(0, "", Hex(bytes_.first(magic_bytes)) + GuessFileKind(bytes_), accepted_magic);
    if (bytes_.size() < sizeof(FileHeader))
      return Fail(bytes_.size(), "header", "the end of the file",
                  fmt::format("{} bytes: the file was cut off", sizeof(FileHeader)));
    std::memcpy(&header_, bytes_.data(), sizeof(FileHeader));
    if (header_.byte_order_mark != kByteOrderMark)
      return Fail(offsetof(FileHeader, byte_order_mark), "byte order",
                  Hex(bytes_.subspan(offsetof(FileHeader, byte_order_mark), 4)) +
                      (header_.byte_order_mark == __builtin_bswap32(kByteOrderMark) ? " (big-endian)" : ""),
                  "04 03 02 01 (little-endian)");
    if (header_.version != kVersion)
      return Fail(
          offsetof(FileHeader, version), "version", std::to_string(header_.version),
          fmt::format("{}{}", kVersion, header_.version > kVersion ? ": a newer Osteon wrote it" : ""));
  }

  /// Reads the section table. Checks its checksum first, then its entries.
  void ReadTable() {
    if (header_.sections < 1 || header_.sections > kMaxSections)
      return Fail(offsetof(FileHeader, sections), "number of sections", std::to_string(header_.sections),
                  fmt::format("1 … {}", kMaxSections));
    const std::size_t table_bytes = header_.sections * sizeof(SectionEntry);
    if (bytes_.size() < sizeof(FileHeader) + table_bytes)
      return Fail(bytes_.size(), "section table", "the end of the file",
                  fmt::format("{} sections of {} bytes: the file was cut off", header_.sections,
                              sizeof(SectionEntry)));
    std::uint32_t crc = Crc(0, bytes_.data(), offsetof(FileHeader, crc));
    crc = Crc(crc, bytes_.data() + sizeof(FileHeader), table_bytes);
    if (crc != header_.crc)
      return Fail(offsetof(FileHeader, crc), "checksum of header and section table",
                  fmt::format("{:08x}", header_.crc), fmt::format("{:08x}, which these bytes have", crc));
    if (header_.zero != 0 || header_.also_zero != 0)
      return Fail(header_.zero != 0 ? offsetof(FileHeader, zero) : offsetof(FileHeader, also_zero), "header",
                  fmt::format("{}", std::max(header_.zero, header_.also_zero)), "0");
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(header_.origin_mm[k]) <= 1e6))
        return Fail(offsetof(FileHeader, origin_mm) + 8 * k, "origin",
                    fmt::format("{} mm", header_.origin_mm[k]), "-1e6 … 1e6 mm");
    packing_.origin_mm_ = {header_.origin_mm[0], header_.origin_mm[1], header_.origin_mm[2]};

    table_.resize(header_.sections);
    std::memcpy(table_.data(), bytes_.data() + sizeof(FileHeader), table_bytes);
    std::uint64_t end = sizeof(FileHeader) + table_bytes;
    for (std::size_t i = 0; i < table_.size() && !error_; ++i) end = CheckEntry(i, end);
    if (error_) return;
    if (end != header_.file_bytes)
      return Fail(offsetof(FileHeader, file_bytes), "size of the file",
                  fmt::format("{} bytes", header_.file_bytes),
                  fmt::format("{}: the end of the last section", end));
    for (const KindInfo& kind : kKinds)
      if (kind.required && !Entry(kind.kind))
        return Fail(sizeof(FileHeader), "section table", fmt::format("no section \"{}\"", kind.name),
                    fmt::format("one (kind {})", kind.kind));
    const SectionEntry* points = Entry(kPoints);
    const SectionEntry* materials = Entry(kPointMaterials);
    if ((points ? points->count : 0) != (materials ? materials->count : 0))
      return Fail(sizeof(FileHeader), "section table",
                  fmt::format("{} mass points with {} materials", points ? points->count : 0,
                              materials ? materials->count : 0),
                  "a material a point");
  }

  /// Checks a section's entry.
  /// @param previous_end  first byte after the previous section. @returns the first byte after this section
  std::uint64_t CheckEntry(std::size_t i, std::uint64_t previous_end) {
    const SectionEntry& entry = table_[i];
    const std::uint64_t at = sizeof(FileHeader) + i * sizeof(SectionEntry);
    const auto info = std::ranges::find(kKinds, entry.kind, &KindInfo::kind);
    if (info == kKinds.end()) {
      Fail(at, fmt::format("section {}", i), fmt::format("kind {}", entry.kind),
           fmt::format("1 … {}", kKinds.size()));
      return previous_end;
    }
    const std::string where = fmt::format("section \"{}\"", info->name);
    for (std::size_t j = 0; j < i; ++j)
      if (table_[j].kind == entry.kind) Fail(at, where, "a second one", "one of each kind");
    if (i > 0 && table_[i - 1].kind > entry.kind)
      Fail(at, where, fmt::format("behind kind {}", table_[i - 1].kind), "kinds in ascending order");
    const std::uint64_t aligned = (previous_end + kAlignment - 1) / kAlignment * kAlignment;
    if (entry.offset > header_.file_bytes || entry.bytes > header_.file_bytes - entry.offset)
      Fail(at + offsetof(SectionEntry, offset), where,
           fmt::format("{} bytes from byte {} on", entry.bytes, entry.offset),
           fmt::format("what lies within the file's {} bytes", header_.file_bytes));
    if (entry.offset < previous_end)
      Fail(at + offsetof(SectionEntry, offset), where,
           fmt::format("that it begins at byte {}, within what lies before it", entry.offset),
           fmt::format("byte {}", aligned));
    if (entry.offset % kAlignment != 0)
      Fail(at + offsetof(SectionEntry, offset), where, fmt::format("that it begins at byte {}", entry.offset),
           fmt::format("a multiple of {}", kAlignment));
    if (entry.offset != aligned)
      Fail(at + offsetof(SectionEntry, offset), where,
           fmt::format("a gap before it: it begins at byte {}", entry.offset),
           fmt::format("byte {}", aligned));
    if (entry.count < 1 || entry.count > info->max_records)
      Fail(at + offsetof(SectionEntry, count), where, fmt::format("{} records", entry.count),
           info->max_records == kAnyNumber ? "1 and more" : fmt::format("1 … {}", info->max_records));
    // divide, because count × record_bytes could overflow: in a damaged file, the count may be any number
    if (entry.bytes / info->record_bytes != entry.count || entry.bytes % info->record_bytes != 0)
      Fail(at + offsetof(SectionEntry, count), where,
           fmt::format("{} records in {} bytes", entry.count, entry.bytes),
           fmt::format("{} bytes a record", info->record_bytes));
    return entry.offset + entry.bytes;
  }

  /// Checks that the file is as long as its table says, with zeros between the sections. The table itself
  /// was checked before.
  void CheckContents() {
    if (bytes_.size() > header_.file_bytes)
      return Fail(header_.file_bytes, "end of the file",
                  fmt::format("{} bytes more", bytes_.size() - header_.file_bytes),
                  "nothing behind the last section");
    std::uint64_t end = sizeof(FileHeader) + table_.size() * sizeof(SectionEntry);
    for (const SectionEntry& entry : table_) {
      if (bytes_.size() < entry.offset + entry.bytes)
        return Fail(bytes_.size(), fmt::format("section \"{}\"", NameOf(entry)), "the end of the file",
                    fmt::format("{} bytes: the file was cut off", header_.file_bytes));
      for (std::uint64_t i = end; i < entry.offset; ++i)
        if (bytes_[i] != std::byte{0})
          return Fail(i, fmt::format("before section \"{}\"", NameOf(entry)), Hex(bytes_.subspan(i, 1)),
                      "00");
      end = entry.offset + entry.bytes;
    }
  }

  void ReadSection(const SectionEntry& entry) {
    switch (entry.kind) {
      case kBalls:
        packing_.balls_ = ReadRecords<PackedBall>(
            entry,
            [](const PackedBall& b) {
              return InReach(b.x_mm, b.y_mm, b.z_mm) && b.radius_mm > 0.0f && b.radius_mm <= kReach_mm;
            },
            &PackingReader::FailBall);
        break;
      case kPoints:
        packing_.points_ = ReadRecords<PackedPoint>(
            entry,
            [](const PackedPoint& p) {
              return InReach(p.x_mm, p.y_mm, p.z_mm) && p.volume_mm3 > 0.0f && p.volume_mm3 <= kMaxVolume_mm3;
            },
            &PackingReader::FailPoint);
        break;
      case kPointMaterials:
        // CheckPointMaterials checks the indices after the materials are read: the materials come later in
        // the file
        packing_.point_materials_ = ReadRecords<MaterialIndex>(
            entry, [](MaterialIndex) { return true; }, nullptr);
        break;
      case kMaterials:
        if (auto materials = MaterialsFromText(Text(entry)))
          packing_.materials_ = std::move(*materials);
        else
          FailText(entry, materials.error());
        CheckPointMaterials();
        break;
      case kSite:
        ReadSite(entry);
        break;
      case kProvenance:
        if (auto provenance = ProvenanceFromText(Text(entry))) {
          packing_.name_ = std::move(provenance->name);
          packing_.provenance_ = std::move(provenance->provenance);
        } else {
          FailText(entry, provenance.error());
        }
        break;
    }
  }

  /// True if each coordinate lies within kReach_mm of the origin.
  static bool InReach(float x, float y, float z) {
    // & instead of && avoids a branch for each coordinate; a NaN is out of reach
    return (std::abs(x) <= kReach_mm) & (std::abs(y) <= kReach_mm) & (std::abs(z) <= kReach_mm);
  }

  /// Returns a section's records. Checks checksum and values in one pass over the bytes, in pieces on all
  /// threads.
  template <typename Record, typename Good>
  std::span<const Record> ReadRecords(const SectionEntry& entry, const Good& good,
                                      void (PackingReader::*fail)(const Record&, const std::string&,
                                                                  std::uint64_t)) {
    // the records are aligned: a mapping begins at a page, and each section at a multiple of 64 bytes
    const std::span<const Record> records(reinterpret_cast<const Record*>(bytes_.data() + entry.offset),
                                          static_cast<std::size_t>(entry.count));
    constexpr std::size_t kPiece = (std::size_t{1} << 20) / sizeof(Record);
    struct Finding {
      std::uint32_t crc{0};
      std::size_t bytes{0}, first_bad{SIZE_MAX};
    };
    std::vector<Finding> findings((records.size() + kPiece - 1) / kPiece);
    ParallelFor(
        records.size(), threads_,
        [&](std::size_t begin, std::size_t end) {
          Finding& finding = findings[begin / kPiece];
          finding.bytes = (end - begin) * sizeof(Record);
          finding.crc = Crc(0, &records[begin], finding.bytes);
          for (std::size_t i = begin; i < end; ++i)
            if (!good(records[i])) {
              finding.first_bad = i;
              break;
            }
        },
        kPiece);
    uLong crc = 0;
    for (const Finding& finding : findings)
      crc = crc32_combine(crc, finding.crc, static_cast<z_off_t>(finding.bytes));
    CheckCrc(entry, static_cast<std::uint32_t>(crc));
    for (const Finding& finding : findings)
      if (!error_ && finding.first_bad != SIZE_MAX) {
        const std::size_t i = finding.first_bad;
        (this->*fail)(records[i], fmt::format("{} {}", entry.kind == kBalls ? "ball" : "mass point", i),
                      entry.offset + i * sizeof(Record));
      }
    return records;
  }

  /// A section's bytes as text, after a check of its checksum.
  std::string_view Text(const SectionEntry& entry) {
    const char* begin = reinterpret_cast<const char*>(bytes_.data() + entry.offset);
    CheckCrc(entry, Crc(0, begin, entry.bytes));
    return {begin, static_cast<std::size_t>(entry.bytes)};
  }

  void CheckCrc(const SectionEntry& entry, std::uint32_t crc) {
    if (crc == entry.crc) return;
    Fail(entry.offset, fmt::format("checksum of section \"{}\"", NameOf(entry)), fmt::format("{:08x}", crc),
         fmt::format("{:08x}, as the section table says: bytes {} … {} were changed", entry.crc, entry.offset,
                     entry.offset + entry.bytes - 1));
  }

  /// Reports the first coordinate out of reach, if any.
  void FailPlace(const std::array<float, 3>& at_mm, const std::string& where, std::uint64_t byte) {
    for (std::size_t k = 0; k < 3; ++k)
      if (!(std::abs(at_mm[k]) <= kReach_mm))
        Fail(byte + 4 * k, where + ": " + "xyz"[k], fmt::format("{} mm", at_mm[k]),
             fmt::format("-{0} … {0} mm from the origin", kReach_mm));
  }
  void FailBall(const PackedBall& ball, const std::string& where, std::uint64_t byte) {
    FailPlace({ball.x_mm, ball.y_mm, ball.z_mm}, where, byte);
    Fail(byte + 12, where + ": radius", fmt::format("{} mm", ball.radius_mm),
         fmt::format("above 0, up to {} mm", kReach_mm));
  }
  void FailPoint(const PackedPoint& point, const std::string& where, std::uint64_t byte) {
    FailPlace({point.x_mm, point.y_mm, point.z_mm}, where, byte);
    Fail(byte + 12, where + ": volume", fmt::format("{} mm^3", point.volume_mm3),
         fmt::format("above 0, up to {} mm^3", kMaxVolume_mm3));
  }
  void FailText(const SectionEntry& entry, const TextError& error) {
    Fail(entry.offset + error.byte,
         fmt::format("section \"{}\"{}{}", NameOf(entry), error.where.empty() ? "" : ": ", error.where),
         error.found, error.accepted);
  }

  /// Checks the points' material indices. Called after the materials are read, which come after the points.
  void CheckPointMaterials() {
    if (error_ || packing_.point_materials_.empty()) return;
    const auto max_material = std::ranges::max_element(packing_.point_materials_);
    if (*max_material < packing_.materials_.size()) return;
    const auto i = static_cast<std::uint64_t>(max_material - packing_.point_materials_.begin());
    const std::size_t listed = packing_.materials_.size();
    Fail(Entry(kPointMaterials)->offset + i, fmt::format("mass point {}", i),
         fmt::format("material {}", *max_material),
         listed == 1 ? "0: one material is listed"
                     : fmt::format("0 … {}: {} materials are listed", listed - 1, listed));
  }

  void ReadSite(const SectionEntry& entry) {
    PackedSite site;
    std::memcpy(&site, bytes_.data() + entry.offset, sizeof(site));
    CheckCrc(entry, Crc(0, &site, sizeof(site)));
    const Vector3 center(site.center_m.data()), axis(site.axis.data());
    if (!(center.cwiseAbs().maxCoeff() <= 1e3) || !center.allFinite())
      Fail(entry.offset, "site: centre", fmt::format("({}, {}, {}) m", center.x(), center.y(), center.z()),
           "within ±1000 m");
    if (!(std::abs(axis.norm() - 1.0) <= 1e-6))
      Fail(entry.offset + offsetof(PackedSite, axis), "site: axis",
           fmt::format("({}, {}, {})", axis.x(), axis.y(), axis.z()), "a length of 1");
    if (!(site.radius_m > 0.0 && site.radius_m <= 1.0))
      Fail(entry.offset + offsetof(PackedSite, radius_m), "site: radius", fmt::format("{} m", site.radius_m),
           "above 0, up to 1 m");
    packing_.site_ = CutSite{.center_m = center, .axis = axis, .radius_m = site.radius_m};
  }

  /// The entry of the section of this kind; null if there is none.
  [[nodiscard]] const SectionEntry* Entry(std::uint32_t kind) const {
    const auto found = std::ranges::find(table_, kind, &SectionEntry::kind);
    return found == table_.end() ? nullptr : &*found;
  }
  static const char* NameOf(const SectionEntry& entry) { return kKinds[entry.kind - 1].name; }

  std::string path_;
  int threads_;
  PackingFile packing_;
  std::span<const std::byte> bytes_;
  FileHeader header_;
  std::vector<SectionEntry> table_;
  std::optional<FileError> error_;
};

tl::expected<PackingFile, FileError> PackingFile::Open(const std::filesystem::path& path, int threads) {
  auto file = MappedFile::Open(path);
  if (!file) return tl::make_unexpected(file.error());
  return PackingReader(std::move(*file), path, threads).Read();
}

Bone PackingFile::ToBone() const {
  const auto place = [this](float x, float y, float z) -> Vector3 {
    return (origin_mm_ + Vector3(x, y, z)) * 1e-3;
  };
  Bone bone{.name = name_, .balls = {}, .points = {}, .materials = materials_, .site = {}};
  bone.balls.resize(balls_.size());
  ParallelFor(
      balls_.size(), 0,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const PackedBall& b = balls_[i];
          bone.balls[i] = {.center_m = place(b.x_mm, b.y_mm, b.z_mm), .radius_m = double{b.radius_mm} * 1e-3};
        }
      },
      std::size_t{1} << 14);
  bone.points.resize(points_.size());
  ParallelFor(
      points_.size(), 0,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const PackedPoint& p = points_[i];
          bone.points[i] = {.p_m = place(p.x_mm, p.y_mm, p.z_mm),
                            .volume_m3 = double{p.volume_mm3} * 1e-9,
                            .material = point_materials_[i]};
        }
      },
      std::size_t{1} << 14);
  bone.site.radius_m = 0.0;
  if (site_) bone.site = *site_;
  return bone;
}

}  // namespace osteon::simulation
