#pragma once

#include <array>
#include <cstdint>

#include "simulation/surface/surface_chunk.h"

// The cells of the dual surface, and how their corners, edges and faces are numbered. A corner's number has
// bit 0 for x, bit 1 for y, bit 2 for z; an edge's number is 4 axis + the bits of its corners along the two
// other axes; a face's number is 2 axis + side. A corner is inside the bone if its value is negative; an edge
// is cut if exactly one of its corners is inside. The cut edges of a cell form closed loops over its faces:
// the patches. Each patch gets one vertex.

namespace osteon::surface {

inline constexpr int kCellEdges = 12;
inline constexpr std::uint8_t kNotCut = 0xff;

/// The patches of a cell with a given set of inside corners.
struct CellCase {
  /// Number of the patch of each edge; kNotCut: the edge is not cut
  std::array<std::uint8_t, kCellEdges> patch{};
  std::uint8_t patches{0};  ///< number of patches
  /// Bit f is set if face f has four cut edges that all belong to one patch. If this is also so in the cell
  /// across the face, four quads would meet in one mesh edge. Both cells then pair the face's cut edges the
  /// other way (`flip`).
  std::uint8_t joined_faces{0};
};

/// Finds the patches of a cell.
/// @param inside  bit k is set if corner k is inside
/// @param flip    bit f is set to pair the cut edges of face f around the outside corners instead of the
///   inside corners
[[nodiscard]] CellCase TraceCell(unsigned inside, unsigned flip);

/// Results of TraceCell(inside, 0) for all 256 values of `inside`.
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

/// The two axes across an edge, in the order in which (across, across, along) is right-handed.
[[nodiscard]] constexpr std::array<int, 2> AxesAcross(int axis) { return {(axis + 1) % 3, (axis + 2) % 3}; }

/// The numbers of one grid edge in the four cells around it. The cells are in counter-clockwise order, seen
/// from the edge's upper end.
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
