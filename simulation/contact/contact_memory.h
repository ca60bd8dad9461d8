#pragma once

#include <array>
#include <cstdint>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// A bone ball and a tool ball that touch, by their indices.
struct ContactPair {
  std::uint32_t bone_ball{0}, tool_ball{0};
  friend bool operator==(const ContactPair&, const ContactPair&) = default;
};

/// Largest number of pairs that stay candidates in the next frame.
inline constexpr int kRememberedPairs = 8;
/// Largest number of faces of the bone that press the tool at once, each with its own mean normal.
inline constexpr int kMaxFaces = 4;

/// State of the contact law that passes from frame to frame. A bin of direction keeps one pair, but a tool
/// rests on up to three pairs, often of the same bin. Therefore the pairs that held the tool stay candidates.
/// Without them the proxy would jump from one pair to the next.
struct ContactMemory {
  /// The first pair_count entries are valid: first the pairs that held the tool, then the nearest other
  /// pairs.
  std::array<ContactPair, kRememberedPairs> pairs{};
  std::int32_t pair_count{0};
  std::int32_t held_count{0};                      ///< number of pairs that held the tool
  std::array<PlainVector3, kMaxFaces> face_n_G{};  ///< unit vectors: the direction in which each face pressed
  std::int32_t face_count{0};
  double friction{0.0};  ///< mu of the touched materials, weighted by engaged area
};

}  // namespace osteon::simulation
