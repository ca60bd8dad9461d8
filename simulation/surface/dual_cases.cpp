#include "simulation/surface/dual_cases.h"

namespace osteon::surface {
namespace {

/// The loops of cut edges: each edge is linked to one other edge across each of its two faces.
struct Links {
  std::array<std::array<int, 2>, kCellEdges> next{};

  Links() {
    for (auto& pair : next) pair = {-1, -1};
  }
  /// Links two edges.
  void Join(int a, int b) {
    At(a) = b;
    At(b) = a;
  }

 private:
  /// The edge's first link that is not set yet.
  int& At(int edge) {
    auto& pair = next[static_cast<std::size_t>(edge)];
    return pair[0] < 0 ? pair[0] : pair[1];
  }
};

/// A face with four cut edges, which are linked in two pairs, and one edge of each pair.
struct AmbiguousFace {
  int face, first, second;
};

}  // namespace

CellCase TraceCell(unsigned inside, unsigned flip) {
  Links links;
  std::array<AmbiguousFace, 6> ambiguous{};
  std::size_t ambiguous_count = 0;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, low = (face & 1) << axis;
    const int u = axis == 0 ? 1 : 0, w = axis == 2 ? 1 : 2;
    const std::array<int, 4> corner{low, low | 1 << u, low | 1 << u | 1 << w,
                                    low | 1 << w};  // the corners in order around the face
    std::array<int, 4> cut{};                       // edge i lies between corners i and i + 1
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const int a = corner[i], b = corner[(i + 1) % 4];
      if ((inside >> a & 1) != (inside >> b & 1)) cut[count++] = EdgeBetween(a, b);
    }
    if (count == 2) links.Join(cut[0], cut[1]);
    if (count != 4) continue;
    // Corner i lies between the edges i - 1 and i. Pair the edges around the two inside corners, or, with
    // `flip`, around the two outside corners.
    const bool around_first = ((inside >> corner[0] & 1) != 0) != ((flip >> face & 1) != 0);
    const std::size_t first = around_first ? 0 : 1;
    links.Join(cut[(first + 3) % 4], cut[first]);
    links.Join(cut[first + 1], cut[(first + 2) % 4]);
    ambiguous[ambiguous_count++] = {face, cut[first], cut[first + 1]};
  }
  // follow each loop of linked edges: its edges form one patch
  CellCase cell;
  cell.patch.fill(kNotCut);
  for (int edge = 0; edge < kCellEdges; ++edge) {
    int at = edge, from = -1;
    if (links.next[static_cast<std::size_t>(at)][0] < 0 ||
        cell.patch[static_cast<std::size_t>(at)] != kNotCut)
      continue;
    while (cell.patch[static_cast<std::size_t>(at)] == kNotCut) {
      cell.patch[static_cast<std::size_t>(at)] = cell.patches;
      const auto& next = links.next[static_cast<std::size_t>(at)];
      const int to = next[0] != from ? next[0] : next[1];
      from = at;
      at = to;
    }
    ++cell.patches;
  }
  for (std::size_t i = 0; i < ambiguous_count; ++i) {
    const AmbiguousFace& face = ambiguous[i];
    if (cell.patch[static_cast<std::size_t>(face.first)] == cell.patch[static_cast<std::size_t>(face.second)])
      cell.joined_faces = static_cast<std::uint8_t>(cell.joined_faces | 1U << face.face);
  }
  return cell;
}

const std::array<CellCase, 256>& CellCases() {
  static const std::array<CellCase, 256> cases = [] {
    std::array<CellCase, 256> all;
    for (unsigned inside = 0; inside < 256; ++inside) all[inside] = TraceCell(inside, 0);
    return all;
  }();
  return cases;
}

}  // namespace osteon::surface
