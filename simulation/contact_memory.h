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

inline constexpr int kRememberedPairs = 8;
/// Faces of the bone that press the tool at once and have a mean normal of their own.
inline constexpr int kMaxFaces = 4;

/// What the contact law carries from frame to frame. A bin keeps one pair, but a tool rests on up to three,
/// often in one bin: those that held it stay candidates. Without them the proxy would hop from one to the
/// next.
struct ContactMemory {
  std::array<ContactPair, kRememberedPairs>
      pairs{};  ///< the first pair_count: what held, then what nearly did
  std::int32_t pair_count{0};
  std::int32_t held_count{0};  ///< of these, that held
  std::array<PlainVector3, kMaxFaces> face_n_G{};  ///< unit; the direction in which each face pressed
  std::int32_t face_count{0};
  double friction{0.0};  ///< mu of what was touched, by engaged area
};

}  // namespace osteon::simulation
