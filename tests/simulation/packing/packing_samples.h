#pragma once

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "simulation/packing/packing_file.h"

// A bone for packing files, and functions that change a file's bytes. They rely only on the layout in
// docs/packing.md: offsets and the checksum are repeated here, not taken from the code under test.

namespace osteon::simulation::test {

/// Balls and points at random places around a middle that is no round number, three materials, a site.
inline Bone SomeBone(std::size_t balls = 40, std::size_t points = 25) {
  std::mt19937_64 random(7);
  const auto uniform = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
  };
  const Vector3 middle(0.0123456789, -0.1876543, 0.5432198765);
  Bone bone;
  bone.name = "some bone";
  for (std::size_t i = 0; i < balls; ++i)
    bone.balls.push_back(
        {.center_m = middle + Vector3(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.2, 0.2)),
         .radius_m = uniform(0.2e-3, 4e-3)});
  for (std::size_t i = 0; i < points; ++i)
    bone.points.push_back(
        {.p_m = middle + Vector3(uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.2, 0.2)),
         .volume_m3 = uniform(1e-12, 3e-9),
         .material = static_cast<MaterialIndex>(random() % 3)});
  for (const char* name : {"enamel", "dentine", "pulp"}) {
    Material material;
    material.name = name;
    material.density_kg_per_m3 = uniform(300, 3000);
    material.density_source = {.text = std::string("measured on a \\ of ") + name + ";\nsecond line, µ = 0,3",
                               .assumed = false};
    material.friction_source = {.text = "as bone", .assumed = true};
    bone.materials.push_back(material);
  }
  bone.site = {.center_m = middle + Vector3(0.01, 0.02, 0.03),
               .axis = Vector3(1, 2, 3).normalized(),
               .radius_m = 0.0237};
  return bone;
}

inline PackingProvenance SomeProvenance() {
  return {.program = "osteon 0.1.0",
          .source = "some bone.obj",
          .source_crc = 0x00beef42,
          .parameters = {{"mode", "overlap"}, {"seed", "7"}, {"r_max_mm", "4"}}};
}

/// CRC bit by bit, from the polynomial (IEEE 802.3), independent of zlib.
inline std::uint32_t SlowCrc(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0u);
  }
  return ~crc;
}

/// Writes a number in the machine's byte order at a byte of the file.
template <typename T>
void Put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(value));
}
/// Reads a number in the machine's byte order at a byte of the file.
template <typename T>
T Get(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

/// Bytes of the header's fields, and of the section table.
constexpr std::size_t kFileBytesAt = 16, kSectionsAt = 24, kOriginAt = 32, kHeaderCrcAt = 60, kTableAt = 64;

/// Byte of a field of the section table: kind, crc, offset, bytes, count.
inline std::size_t EntryAt(std::size_t section, const std::string& field = "kind") {
  const std::size_t within = field == "kind"     ? 0
                             : field == "crc"    ? 4
                             : field == "offset" ? 8
                             : field == "bytes"  ? 16
                                                 : 24;
  return kTableAt + 32 * section + within;
}
/// Byte at which a section's content begins.
inline std::size_t SectionAt(const std::string& bytes, std::size_t section) {
  return static_cast<std::size_t>(Get<std::uint64_t>(bytes, EntryAt(section, "offset")));
}

/// Recomputes the checksum of header and table.
inline void SealHeader(std::string& bytes) {
  const std::size_t table = 32 * std::size_t{Get<std::uint32_t>(bytes, kSectionsAt)};
  Put(bytes, kHeaderCrcAt, SlowCrc(bytes.substr(0, kHeaderCrcAt) + bytes.substr(kTableAt, table)));
}
/// Recomputes every section's checksum, then the header's.
inline void Seal(std::string& bytes) {
  for (std::size_t i = 0; i < Get<std::uint32_t>(bytes, kSectionsAt); ++i)
    Put(bytes, EntryAt(i, "crc"),
        SlowCrc(bytes.substr(SectionAt(bytes, i), Get<std::uint64_t>(bytes, EntryAt(i, "bytes")))));
  SealHeader(bytes);
}

/// Recomputes the checksums of damaged bytes where possible, so that other checks must find the damage; a
/// table that points outside the file stays as it is.
inline void SealIfPossible(std::string& bytes) {
  if (bytes.size() < kTableAt) return;
  const std::size_t sections = Get<std::uint32_t>(bytes, kSectionsAt);
  if (sections > 16 || kTableAt + 32 * sections > bytes.size()) return;
  Put(bytes, kFileBytesAt, std::uint64_t{bytes.size()});
  for (std::size_t i = 0; i < sections; ++i) {
    const auto offset = Get<std::uint64_t>(bytes, EntryAt(i, "offset")),
               size = Get<std::uint64_t>(bytes, EntryAt(i, "bytes"));
    if (offset <= bytes.size() && size <= bytes.size() - offset)
      Put(bytes, EntryAt(i, "crc"), SlowCrc(bytes.substr(offset, size)));
  }
  SealHeader(bytes);
}

/// Kind, number of records and bytes of one section of a file.
struct SampleSection {
  std::uint32_t kind;
  std::uint64_t count;
  std::string content;
};

/// The sections of a good file.
inline std::vector<SampleSection> Sections(const std::string& bytes) {
  std::vector<SampleSection> sections;
  for (std::size_t i = 0; i < Get<std::uint32_t>(bytes, kSectionsAt); ++i)
    sections.push_back(
        {.kind = Get<std::uint32_t>(bytes, EntryAt(i)),
         .count = Get<std::uint64_t>(bytes, EntryAt(i, "count")),
         .content = bytes.substr(SectionAt(bytes, i), Get<std::uint64_t>(bytes, EntryAt(i, "bytes")))});
  return sections;
}

/// A file with a valid file's header and these sections, with checksums.
inline std::string Compose(const std::string& good, const std::vector<SampleSection>& sections) {
  std::string bytes = good.substr(0, kTableAt) + std::string(32 * sections.size(), '\0');
  Put(bytes, kSectionsAt, static_cast<std::uint32_t>(sections.size()));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    bytes.resize((bytes.size() + 63) / 64 * 64, '\0');
    Put(bytes, EntryAt(i), sections[i].kind);
    Put(bytes, EntryAt(i, "offset"), std::uint64_t{bytes.size()});
    Put(bytes, EntryAt(i, "bytes"), std::uint64_t{sections[i].content.size()});
    Put(bytes, EntryAt(i, "count"), sections[i].count);
    bytes += sections[i].content;
  }
  Put(bytes, kFileBytesAt, std::uint64_t{bytes.size()});
  Seal(bytes);
  return bytes;
}

}  // namespace osteon::simulation::test
