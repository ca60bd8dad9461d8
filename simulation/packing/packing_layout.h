#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

// The bytes of a packing file (.osp), version 1. Little-endian. Every section begins at a multiple of 64
// bytes, with zeros in between and nothing after the last; sections are in the order of their kinds.
// docs/packing.md describes every byte.
//
//     0   FileHeader, 64 bytes       magic, version, size of the file, origin, checksum of header and table
//    64   SectionEntry, 32 bytes     one for each section: kind, checksum, offset, bytes, count
//         sections                   balls, mass points, their materials, materials, site, provenance
//
// Coordinates and radii are float32 millimetres, coordinates relative to the origin, as the shaders need
// them. They are multiples of kGrid_mm, so that adding the origin in double precision and subtracting it
// again gives the same value. A loaded packing is therefore saved with the same bytes.

namespace osteon::simulation::packing_layout {

static_assert(std::endian::native == std::endian::little, "packing files are mapped, not decoded");

/// The first bytes of a file. As in PNG, they are chosen so that a text-mode transfer, a 7-bit channel or
/// changed line ends damage them.
inline constexpr std::array<unsigned char, 8> kMagic{0x89, 'O', 'S', 'P', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kByteOrderMark = 0x01020304;
inline constexpr std::uint32_t kVersion = 1;
inline constexpr std::size_t kAlignment = 64;
inline constexpr std::uint32_t kMaxSections = 16;

inline constexpr double kGrid_mm = 0x1p-15;    ///< 31 nm; float32 holds its multiples exactly up to 512 mm
inline constexpr float kReach_mm = 512.0f;     ///< largest distance from the origin along an axis
inline constexpr float kMaxVolume_mm3 = 1e9f;  ///< largest volume of a mass point
inline constexpr std::size_t kMaxTextBytes = std::size_t{1}
                                             << 20;  ///< largest size of the text of materials or provenance

enum SectionKind : std::uint32_t {
  kBalls = 1,           ///< one PackedBall each
  kPoints = 2,          ///< one PackedPoint each
  kPointMaterials = 3,  ///< one byte each: index of a material
  kMaterials = 4,       ///< text, counted in bytes
  kSite = 5,            ///< PackedSite, one
  kProvenance = 6,      ///< text, counted in bytes
};

struct FileHeader {
  std::array<unsigned char, 8> magic{kMagic};
  std::uint32_t byte_order_mark{kByteOrderMark};
  std::uint32_t version{kVersion};
  std::uint64_t file_bytes{0};
  std::uint32_t sections{0};
  std::uint32_t zero{0};              ///< unused, must be 0
  std::array<double, 3> origin_mm{};  ///< origin of balls and points, in G
  std::uint32_t also_zero{0};         ///< unused, must be 0
  std::uint32_t crc{0};               ///< checksum of the 60 bytes before it and then the table
};
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, file_bytes) == 16 &&
              offsetof(FileHeader, origin_mm) == 32 && offsetof(FileHeader, crc) == 60);

struct SectionEntry {
  std::uint32_t kind{0};
  std::uint32_t crc{0};     ///< checksum of the section's bytes
  std::uint64_t offset{0};  ///< offset of the section from the file's first byte
  std::uint64_t bytes{0};
  std::uint64_t count{0};  ///< number of records
};
static_assert(sizeof(SectionEntry) == 32 && offsetof(SectionEntry, offset) == 8);

/// The site (a cup), in G. Its values are doubles in SI units, unlike the float32 millimetres of balls and
/// points.
struct PackedSite {
  std::array<double, 3> center_m{}, axis{};
  double radius_m{0.0};
};
static_assert(sizeof(PackedSite) == 56);

}  // namespace osteon::simulation::packing_layout
