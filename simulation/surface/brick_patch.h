#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// Number of nodes along a patch: the nodes -2 … 9 of a brick. These are the nodes of the brick's cells -1 …
/// 7, and one more on each side for central differences.
inline constexpr int kPatchEdge = 12;
inline constexpr int kPatchNodes = kPatchEdge * kPatchEdge * kPatchEdge;
/// Steps of the index along y and z
inline constexpr int kRow = kPatchEdge, kLayer = kPatchEdge * kPatchEdge;

/// The nodes in and around a brick, copied from the brick and its 26 neighbours.
struct BrickPatch {
  enum Fields : std::uint8_t { kNone = 0, kSolid = 1, kSwept = 2, kBoth = 3 };
  Fields fields{kNone};  ///< the fields that are not -kFieldLimit everywhere; only these are filled in
  std::array<std::int16_t, kPatchNodes> solid, swept;
  std::array<std::int16_t, kPatchNodes> both;  ///< max(solid, swept); only with kBoth

  /// The field whose zero level is the carved surface. @pre fields is not kNone
  [[nodiscard]] const std::int16_t* carved() const {
    return fields == kBoth ? both.data() : fields == kSolid ? solid.data() : swept.data();
  }
};

/// Fills the patch of a brick. @returns false if no surface can pass through it: the brick and all its
/// neighbours are bone, or all are air
[[nodiscard]] bool GatherPatch(const CarvedField& field, BrickIndex brick, BrickPatch& patch);

}  // namespace osteon::surface
