#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/carved_field.h"

namespace osteon::surface {

/// Number of nodes -2 … 9 along a brick: those of its cells -1 … 7 and of the cells' central differences.
inline constexpr int kPatchEdge = 12;
inline constexpr int kPatchNodes = kPatchEdge * kPatchEdge * kPatchEdge;
inline constexpr int kRow = kPatchEdge, kLayer = kPatchEdge * kPatchEdge;  ///< steps along y and z

/// The nodes around a brick, copied together from it and its 26 neighbours.
struct BrickPatch {
  enum Fields : std::uint8_t { kNone = 0, kSolid = 1, kSwept = 2, kBoth = 3 };
  Fields fields{kNone};  ///< those that are not at -kFieldLimit everywhere; only they are filled in
  std::array<std::int16_t, kPatchNodes> solid, swept;
  std::array<std::int16_t, kPatchNodes> both;  ///< max(solid, swept); only with kBoth

  /// The field whose zeros are the surface. @pre fields is not kNone
  [[nodiscard]] const std::int16_t* carved() const {
    return fields == kBoth ? both.data() : fields == kSolid ? solid.data() : swept.data();
  }
};

/// Fills the patch of a brick. @returns false if no surface can pass: the brick and all its neighbours are
/// bone, or all are air
[[nodiscard]] bool GatherPatch(const CarvedField& field, BrickIndex brick, BrickPatch& patch);

}  // namespace osteon::surface
