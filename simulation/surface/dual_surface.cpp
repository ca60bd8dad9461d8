#include "simulation/surface/dual_surface.h"

#include <array>
#include <bit>

#include "simulation/surface/brick_patch.h"
#include "simulation/surface/cell_vertex.h"
#include "simulation/surface/dual_cases.h"

namespace osteon::surface {
namespace {

constexpr int kCells = kCellEdge * kCellEdge * kCellEdge;
constexpr int kFieldSolid = 0, kFieldSwept = 1;
/// Steps of the index between neighbours along each axis: for a patch's nodes, and for a brick's cells.
constexpr std::array<int, 3> kNodeStep{1, kRow, kLayer}, kCellStep{1, kCellEdge, kCellEdge*kCellEdge};

/// A bit mask: bit k is set if corner k of a cell is inside.
/// @param at  index of the cell's lowest node in the patch
unsigned InsideMask(const std::int16_t* carved, int at) {
  unsigned mask = 0;
  for (unsigned k = 0; k < 8; ++k) mask |= carved[at + kCornerStep[k]] < 0 ? 1U << k : 0U;
  return mask;
}

/// Index in the patch of the brick's node (x, y, z). Node (-1, -1, -1) of a brick is node (1, 1, 1) of its
/// patch.
int PatchNode(int x, int y, int z) { return (z + 2) * kLayer + (y + 2) * kRow + x + 2; }

/// Extracts the mesh of one brick.
class Extractor {
 public:
  Extractor(const CarvedField& field, const ExtractOptions& options, const MaterialAt& material,
            const BrickPatch& patch, SurfaceChunk& chunk)
      : layout_(field.layout()),
        options_(options),
        material_(material),
        patch_(patch),
        carved_(patch.carved()),
        place_(layout_.PlaceOf(chunk.brick)),
        chunk_(chunk) {}

  /// Makes all cells that the surface passes, then a quad for each cut edge that begins at a node of the
  /// brick.
  void Run() {
    FindInsideRows();
    for (int z = -1; z < kBrickEdge; ++z)
      for (int y = -1; y < kBrickEdge; ++y) {
        // Make the cells that have corners both inside and outside.
        const unsigned a = Row(y, z), b = Row(y + 1, z), c = Row(y, z + 1), d = Row(y + 1, z + 1);
        const unsigned all = a & b & c & d, any = a | b | c | d;
        EachBit((any | any >> 1) & ~(all & all >> 1) & kCellBits,
                [&](int bit) { MakeCell(bit - 2, y, z, InsideMask(carved_, PatchNode(bit - 2, y, z))); });
      }
    for (int z = 0; z < kBrickEdge; ++z)
      for (int y = 0; y < kBrickEdge; ++y) {
        const unsigned row = Row(y, z);
        const std::array<unsigned, 3> cut{row ^ row >> 1, row ^ Row(y + 1, z), row ^ Row(y, z + 1)};
        for (int axis = 0; axis < 3; ++axis)
          EachBit(cut[static_cast<std::size_t>(axis)] & kNodeBits,
                  [&](int bit) { MakeQuad(bit - 2, y, z, axis); });
      }
  }

 private:
  /// A cell's patches, and for each patch its vertex on the solid's face and its vertex on the swept face.
  struct Cell {
    std::array<std::uint8_t, kCellEdges> patch;
    std::array<std::array<std::uint16_t, 2>, kMaxPatches> vertex;
  };

  /// Bits of a row of a patch's nodes: bit 2 is the brick's node 0. Its cells begin at the nodes -1 … 7.
  static constexpr unsigned kNodeBits = 0xffU << 2, kCellBits = 0x1ffU << 1;

  /// Stores which nodes are inside, as one word of bits for each row along x.
  void FindInsideRows() {
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const std::int16_t* values = carved_ + row * kPatchEdge;
      unsigned inside = 0;
      for (unsigned x = 0; x < kPatchEdge; ++x) inside |= (values[x] < 0 ? 1U : 0U) << x;
      rows_[row] = static_cast<std::uint16_t>(inside);
    }
  }
  /// Bits of a row along x: bit x + 2 is set if the brick's node (x, y, z) is inside.
  [[nodiscard]] unsigned Row(int y, int z) const {
    return rows_[static_cast<std::size_t>((z + 2) * kPatchEdge + y + 2)];
  }

  /// Calls visit(number of the bit) for each bit that is set.
  template <class Visit>
  static void EachBit(unsigned bits, const Visit& visit) {
    for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
  }

  /// Index in cells_ of the cell that begins at node (x, y, z).
  [[nodiscard]] static int CellNumber(int x, int y, int z) {
    return ((z + 1) * kCellEdge + y + 1) * kCellEdge + x + 1;
  }

  /// Finds the cell's patches. If a face's four cut edges belong to one patch in both of its cells, the edges
  /// are paired the other way.
  [[nodiscard]] CellCase CaseOf(unsigned inside, int at) const {
    const CellCase& plain = CellCases()[inside];
    unsigned flip = 0;
    for (unsigned face = 0; face < 6; ++face) {
      if ((plain.joined_faces >> face & 1U) == 0) continue;
      const int step = kNodeStep[face / 2];
      const unsigned across = InsideMask(carved_, (face & 1U) != 0 ? at + step : at - step);
      if ((CellCases()[across].joined_faces >> (face ^ 1U) & 1U) != 0) flip |= 1U << face;
    }
    return flip == 0 ? plain : TraceCell(inside, flip);
  }

  /// The point at which the edge between two nodes of the patch crosses the surface.
  [[nodiscard]] EdgeCut CutOfNodes(int at, int to) const {
    constexpr float kVoxels = 1.0F / kStepsOfVoxel;
    if (patch_.fields == BrickPatch::kBoth)
      return CutEdge(kVoxels * static_cast<float>(patch_.solid[static_cast<std::size_t>(at)]),
                     kVoxels * static_cast<float>(patch_.solid[static_cast<std::size_t>(to)]),
                     kVoxels * static_cast<float>(patch_.swept[static_cast<std::size_t>(at)]),
                     kVoxels * static_cast<float>(patch_.swept[static_cast<std::size_t>(to)]));
    const float low = carved_[at], high = carved_[to];
    return {.t = low / (low - high), .by_swept = patch_.fields == BrickPatch::kSwept};
  }

  /// Finds a cell's patches, and makes the vertices of each patch: one, or two on a rim.
  void MakeCell(int x, int y, int z, unsigned inside) {
    const int at = PatchNode(x, y, z), number = CellNumber(x, y, z);
    const CellCase cell_case = CaseOf(inside, at);
    Cell& cell = cells_[static_cast<std::size_t>(number)];
    cell.patch = cell_case.patch;
    // for each patch, the mean of the points where its edges are cut
    std::array<Vec3, kMaxPatches> sum{};
    std::array<int, kMaxPatches> count{};
    std::array<unsigned, kMaxPatches> fields{};  // for each patch, a bit for each field that its edges cross
    for (int edge = 0; edge < kCellEdges; ++edge) {
      const std::size_t k = cell_case.patch[static_cast<std::size_t>(edge)];
      if (k == kNotCut) continue;
      const int low = EdgeCorner(edge, 0), high = EdgeCorner(edge, 1);
      const EdgeCut cut = CutOfNodes(at + kCornerStep[static_cast<std::size_t>(low)],
                                     at + kCornerStep[static_cast<std::size_t>(high)]);
      Vec3 p{static_cast<float>(low & 1), static_cast<float>(low >> 1 & 1), static_cast<float>(low >> 2)};
      (edge < 4 ? p.x : edge < 8 ? p.y : p.z) += cut.t;
      sum[k] = sum[k] + p;
      ++count[k];
      fields[k] |= 1U << (cut.by_swept ? kFieldSwept : kFieldSolid);
    }
    for (std::size_t k = 0; k < cell_case.patches; ++k) {
      const Vec3 mean = (1.0F / static_cast<float>(count[k])) * sum[k];
      const Vec3 in_cell = PlaceVertex(at, mean, fields[k] == 3U && cell_case.patches == 1);
      AddVertices(x, y, z, k, in_cell, fields[k], cell);
    }
  }

  /// Place of a patch's vertex in its cell.
  /// @param mean  mean of the points where the patch's edges are cut
  [[nodiscard]] Vec3 PlaceVertex(int at, Vec3 mean, bool on_rim) const {
    Vec3 place = mean;
    if (on_rim && options_.sharp_rims &&
        FindRim(CornersOf(patch_.solid.data(), at), CornersOf(patch_.swept.data(), at), place))
      return place;
    return ProjectOnto(CornersOf(carved_, at), mean);
  }

  /// Appends the vertices of patch k, one for each field that its edges cross.
  /// @param in_cell  place of the vertices in the cell
  void AddVertices(int x, int y, int z, std::size_t k, Vec3 in_cell, unsigned fields, Cell& cell) {
    const auto along = [](int brick, int node, float offset) {
      return static_cast<float>(brick * kBrickEdge + node) + offset;
    };
    // Compute the position from the cell's place in the whole grid, so that every brick with this cell gets
    // the same bits.
    const Vec3 p_mm = layout_.origin_mm + layout_.voxel_mm * Vec3{along(place_[0], x, in_cell.x),
                                                                  along(place_[1], y, in_cell.y),
                                                                  along(place_[2], z, in_cell.z)};
    const std::uint8_t material = material_ ? material_(p_mm) : std::uint8_t{0};
    for (int field = 0; field < 2; ++field) {
      if ((fields >> field & 1U) == 0) continue;
      const std::int16_t* values = field == kFieldSwept ? patch_.swept.data() : patch_.solid.data();
      const Vec3 gradient = SmoothGradient(values, PatchNode(x, y, z), in_cell);
      const float length = Norm(gradient);
      cell.vertex[k][static_cast<std::size_t>(field)] = static_cast<std::uint16_t>(chunk_.vertices.size());
      chunk_.vertices.push_back(
          {.p_mm = p_mm,
           .normal = length > 0.0F ? (1.0F / length) * gradient : Vec3{0.0F, 0.0F, 1.0F},
           .material = material,
           .cut = field == kFieldSwept,
           .key = static_cast<std::uint16_t>(CellNumber(x, y, z) * kMaxPatches + static_cast<int>(k))});
    }
  }

  /// Makes the quad around the edge from node (x, y, z) along an axis, from one vertex of each of the four
  /// cells around the edge.
  void MakeQuad(int x, int y, int z, int axis) {
    const int at = PatchNode(x, y, z), to = at + kNodeStep[static_cast<std::size_t>(axis)];
    const bool low_inside = carved_[at] < 0;
    const auto [b, c] = AxesAcross(axis);
    const int step_b = kCellStep[static_cast<std::size_t>(b)],
              step_c = kCellStep[static_cast<std::size_t>(c)];
    const int number = CellNumber(x, y, z);
    const std::array<int, 4> around{number - step_b - step_c, number - step_c, number, number - step_b};
    const std::size_t field = CutOfNodes(at, to).by_swept ? kFieldSwept : kFieldSolid;
    std::array<std::uint16_t, 4> quad{};
    for (std::size_t i = 0; i < 4; ++i) {
      const Cell& cell = cells_[static_cast<std::size_t>(around[i])];
      const int edge = kEdgeInCells[static_cast<std::size_t>(axis)][i];
      quad[i] = cell.vertex[cell.patch[static_cast<std::size_t>(edge)]][field];
    }
    if (!low_inside) std::reverse(quad.begin(), quad.end());
    chunk_.quads.insert(chunk_.quads.end(), quad.begin(), quad.end());
  }

  const BrickLayout& layout_;
  const ExtractOptions& options_;
  const MaterialAt& material_;
  const BrickPatch& patch_;
  const std::int16_t* carved_;
  std::array<int, 3> place_;
  SurfaceChunk& chunk_;
  std::array<std::uint16_t, std::size_t{kPatchEdge} * kPatchEdge> rows_;
  std::array<Cell, kCells> cells_;  // only those with cut edges are filled in
};

}  // namespace

void ExtractChunk(const CarvedField& field, BrickIndex brick, SurfaceChunk& chunk,
                  const ExtractOptions& options, const MaterialAt& material) {
  chunk.brick = brick;
  chunk.vertices.clear();
  chunk.quads.clear();
  BrickPatch patch;
  if (GatherPatch(field, brick, patch)) Extractor(field, options, material, patch, chunk).Run();
}

}  // namespace osteon::surface
