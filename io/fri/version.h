#pragma once

#include <array>
#include <cstdint>

// The supported versions of FRI, and their differences on the wire. Header only, because the simulated arm
// uses it too.

namespace osteon::io {

/// Versions that share one wire format.
enum class FriFamily : std::uint8_t {
  k1,    ///< versions 1.11 … 1.16: protobuf without frame; the arm sends its commanded position, which the
         ///< client mirrors
  k2_5,  ///< protobuf without frame; the arm sends Cartesian poses instead of its commanded position; while
         ///< monitoring, the client sends only a header
  k2_7,  ///< as 2.5, but with a frame of length and CRC-32; the arm also sends its external force
};

enum class FriVersion : std::uint8_t { k1_11, k1_12, k1_13, k1_14, k1_15, k1_16, k2_5, k2_7 };

inline constexpr std::array<FriVersion, 8> kFriVersions{
    FriVersion::k1_11, FriVersion::k1_12, FriVersion::k1_13, FriVersion::k1_14,
    FriVersion::k1_15, FriVersion::k1_16, FriVersion::k2_5,  FriVersion::k2_7};

/// The version's name in the robot program's library and the cell's YAML, e.g. "1.15".
[[nodiscard]] constexpr const char* Name(FriVersion version) noexcept {
  constexpr std::array<const char*, 8> names{"1.11", "1.12", "1.13", "1.14", "1.15", "1.16", "2.5", "2.7"};
  return names[static_cast<std::size_t>(version)];
}

[[nodiscard]] constexpr FriFamily FamilyOf(FriVersion version) noexcept {
  if (version == FriVersion::k2_7) return FriFamily::k2_7;
  return version == FriVersion::k2_5 ? FriFamily::k2_5 : FriFamily::k1;
}

/// A family's name for use in a sentence.
[[nodiscard]] constexpr const char* Describe(FriFamily family) noexcept {
  constexpr std::array<const char*, 3> names{"FRI 1.11 to 1.16", "FRI 2.5", "FRI 2.7 (framed)"};
  return names[static_cast<std::size_t>(family)];
}

}  // namespace osteon::io
