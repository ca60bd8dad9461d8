#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/brick_patch.h"

// Where a cell's vertex lies. Places are within the cell, 0 … 1 along each axis; values are in voxels.

namespace osteon::surface {

using CornerValues = std::array<float, 8>;

/// Steps from a cell's low node to its corners, in a patch.
inline constexpr std::array<int, 8> kCornerStep{0,      1,          kRow,          kRow + 1,
                                                kLayer, kLayer + 1, kLayer + kRow, kLayer + kRow + 1};

[[nodiscard]] CornerValues CornersOf(const std::int16_t* field, int at);

struct FieldSample {
  float value{0.0F};
  Vec3 gradient;
};
/// The trilinear interpolant of the corners.
[[nodiscard]] FieldSample Interpolate(const CornerValues& corners, Vec3 place);

/// Interpolated central differences of a patch's field: along the outward normal.
[[nodiscard]] Vec3 SmoothGradient(const std::int16_t* field, int at, Vec3 place);

/// Where a grid edge leaves the bone, and by which of the two fields.
struct EdgeCut {
  float t{0.0F};  ///< from the lower end, 0 … 1
  bool by_swept{false};
};
/// Of the two fields' crossings, the one that is met first from inside. @pre max(solid, swept) changes sign
[[nodiscard]] EdgeCut CutEdge(float solid_low, float solid_high, float swept_low, float swept_high);

/// One Newton step onto the zero of the interpolant, kept within the cell.
[[nodiscard]] Vec3 ProjectOnto(const CornerValues& corners, Vec3 place);

/// The place near `place` where both fields are zero: a sharp rim between old surface and cut. False where
/// the two are less than 10 degrees apart, or meet outside the cell.
[[nodiscard]] bool FindRim(const CornerValues& solid, const CornerValues& swept, Vec3& place);

}  // namespace osteon::surface
