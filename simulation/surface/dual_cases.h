#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/surface_chunk.h"

// Cells of the dual surface. Corners: bit 0 x, bit 1 y, bit 2 z. Edges: 4 axis + the other two bits. Faces:
// 2 axis + side. A corner is inside the bone where its value is negative; an edge is cut where one of its
// corners is inside. The cut edges of a cell form closed loops over its faces: the patches. Each has a
// vertex.

namespace osteon::surface {

inline constexpr int kCellEdges = 12;
inline constexpr std::uint8_t kNotCut = 0xff;

/// The patches of a cell with a given set of inside corners.
struct CellCase {
  std::array<std::uint8_t, kCellEdges> patch{};  ///< of each edge; kNotCut
  std::uint8_t patches{0};
  /// Faces with four cut edges that belong to one patch: bit f. Where the cell across such a face has it as
  /// well, four quads would meet in one edge; both cells then pair the face's edges the other way (`flip`).
  std::uint8_t joined_faces{0};
};

/// @param inside  bit k: corner k is inside
/// @param flip    bit f: pairs the cut edges of face f around the outside corners, not the inside ones
[[nodiscard]] CellCase TraceCell(unsigned inside, unsigned flip);

/// TraceCell(inside, 0) of all 256 sets.
[[nodiscard]] const std::array<CellCase, 256>& CellCases();

/// The corner at the lower (0) or upper (1) end of an edge.
[[nodiscard]] constexpr int EdgeCorner(int edge, int end) {
  const int axis = edge >> 2, other = edge & 3;
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  return ((other & 1) << b) | ((other >> 1) << c) | (end << axis);
}

/// The edge between two corners that differ in one bit.
[[nodiscard]] constexpr int EdgeBetween(int a, int b) {
  const int bit = a ^ b, axis = bit == 1 ? 0 : bit == 2 ? 1 : 2, low = a & ~bit;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return axis * 4 + (low >> first & 1) + ((low >> second & 1) << 1);
}

/// The axes across an edge, so that (across, across, along) turn right.
[[nodiscard]] constexpr std::array<int, 2> AxesAcross(int axis) { return {(axis + 1) % 3, (axis + 2) % 3}; }

/// Numbers that one grid edge has in the four cells around it, counter-clockwise seen from its upper end.
inline constexpr std::array<std::array<int, 4>, 3> kEdgeInCells = [] {
  std::array<std::array<int, 4>, 3> edges{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto [b, c] = AxesAcross(axis);
    for (int k = 0; k < 4; ++k) {
      const int low = (k == 0 || k == 3 ? 1 << b : 0) | (k == 0 || k == 1 ? 1 << c : 0);
      edges[static_cast<std::size_t>(axis)][static_cast<std::size_t>(k)] = EdgeBetween(low, low | 1 << axis);
    }
  }
  return edges;
}();

}  // namespace osteon::surface
