#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/brick_patch.h"

// Functions that compute where a cell's vertex lies. A place is relative to the cell, 0 … 1 along each axis.
// Values of the fields are in voxels.

namespace osteon::surface {

using CornerValues = std::array<float, 8>;

/// Steps of a patch's index from a cell's lowest node to its eight corners.
inline constexpr std::array<int, 8> kCornerStep{0,      1,          kRow,          kRow + 1,
                                                kLayer, kLayer + 1, kLayer + kRow, kLayer + kRow + 1};

/// The field's values at a cell's corners [voxels]. @param at  index of the cell's lowest node in the patch
[[nodiscard]] CornerValues CornersOf(const std::int16_t* field, int at);

/// Value and gradient of a field at a place.
struct FieldSample {
  float value{0.0F};
  Vec3 gradient;
};
/// Interpolates the corners' values trilinearly.
[[nodiscard]] FieldSample Interpolate(const CornerValues& corners, Vec3 place);

/// Interpolates the central differences of a patch's field. The result points along the outward normal.
[[nodiscard]] Vec3 SmoothGradient(const std::int16_t* field, int at, Vec3 place);

/// The point at which a grid edge crosses the carved surface, and the field that is zero there.
struct EdgeCut {
  float t{0.0F};  ///< position on the edge, 0 (lower end) … 1
  bool by_swept{false};
};
/// Finds the crossing: starting from the edge's end in bone, the first zero of either field.
/// @pre max(solid, swept) changes sign along the edge
[[nodiscard]] EdgeCut CutEdge(float solid_low, float solid_high, float swept_low, float swept_high);

/// Takes one Newton step towards the zero of the interpolated field, and stays within the cell.
[[nodiscard]] Vec3 ProjectOnto(const CornerValues& corners, Vec3 place);

/// Moves `place` to the nearest place where both fields are zero: a sharp rim between old surface and cut.
/// @returns false, with `place` unchanged, if the two faces are less than 10 degrees apart, or meet outside
///   the cell.
[[nodiscard]] bool FindRim(const CornerValues& solid, const CornerValues& swept, Vec3& place);

}  // namespace osteon::surface
