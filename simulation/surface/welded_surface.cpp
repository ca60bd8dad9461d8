#include "simulation/surface/welded_surface.h"

#include <algorithm>
#include <unordered_map>

namespace osteon::surface {
namespace {

/// A number that identifies the vertex's cell in the whole grid, and its patch: z, y, x, patch, from the
/// highest bits down.
std::uint64_t GlobalKey(const BrickLayout& layout, const SurfaceChunk& chunk, const SurfaceVertex& vertex) {
  const auto brick = layout.PlaceOf(chunk.brick);
  const int cell = vertex.key / kMaxPatches;
  // Coordinate of a cell in the whole grid, from the brick's coordinate b and the cell's coordinate c in the
  // brick.
  const auto along = [](int b, int c) { return static_cast<std::uint64_t>(b * kBrickEdge + c); };
  constexpr int kBits = 20;  // number of bits for each coordinate
  std::uint64_t key = along(brick[2], cell / (kCellEdge * kCellEdge));
  key = key << kBits | along(brick[1], cell / kCellEdge % kCellEdge);
  key = key << kBits | along(brick[0], cell % kCellEdge);
  return key << 2 | static_cast<std::uint64_t>(vertex.key % kMaxPatches);
}

}  // namespace

WeldedSurface WeldSurface(const CarvedField& field, const ExtractOptions& options) {
  WeldedSurface mesh;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_by_key;
  std::vector<std::uint32_t> mesh_vertex;  // for each vertex of the chunk, its number in the mesh
  SurfaceChunk chunk;
  for (BrickIndex brick = 0; brick < field.layout().Count(); ++brick) {
    ExtractChunk(field, brick, chunk, options);
    mesh_vertex.clear();
    for (const SurfaceVertex& vertex : chunk.vertices) {
      const auto [it, is_new] = vertex_by_key.try_emplace(
          GlobalKey(field.layout(), chunk, vertex), static_cast<std::uint32_t>(mesh.vertices_mm.size()));
      if (is_new) mesh.vertices_mm.push_back(vertex.p_mm);
      mesh_vertex.push_back(it->second);
    }
    for (std::size_t i = 0; i + 3 < chunk.quads.size(); i += 4)
      mesh.quads.push_back({mesh_vertex[chunk.quads[i]], mesh_vertex[chunk.quads[i + 1]],
                            mesh_vertex[chunk.quads[i + 2]], mesh_vertex[chunk.quads[i + 3]]});
  }
  // Cells at the faces between bricks belong to several bricks, and a chunk may have vertices without a quad.
  RemoveUnusedVertices(mesh);
  return mesh;
}

void RemoveUnusedVertices(WeldedSurface& mesh) {
  // Marks the used vertices with 1; later the marks become the vertices' new numbers.
  std::vector<std::uint32_t> used(mesh.vertices_mm.size(), 0);
  for (const auto& quad : mesh.quads)
    for (const std::uint32_t v : quad) used[v] = 1;
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    mesh.vertices_mm[count] = mesh.vertices_mm[i];
    used[i] = count++;
  }
  mesh.vertices_mm.resize(count);
  for (auto& quad : mesh.quads)
    for (std::uint32_t& v : quad) v = used[v];
}

EdgeCounts CountEdges(const WeldedSurface& mesh) {
  // A half edge is one number: its first vertex in the high 32 bits, its second in the low ones.
  std::vector<std::uint64_t> edges;
  edges.reserve(4 * mesh.quads.size());
  for (const auto& quad : mesh.quads)
    for (std::size_t i = 0; i < 4; ++i)
      edges.push_back(static_cast<std::uint64_t>(quad[i]) << 32 | quad[(i + 1) % 4]);
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i > 0 && edges[i] == edges[i - 1]) ++counts.over_shared;
    const std::uint64_t opposite = edges[i] << 32 | edges[i] >> 32;
    if (!std::binary_search(edges.begin(), edges.end(), opposite)) ++counts.open;
  }
  return counts;
}

double VolumeUnder(const WeldedSurface& mesh, const std::array<std::uint32_t, 4>& quad) {
  // Six times the signed volume of the tetrahedron of a, b, c and the origin.
  const auto tetrahedron = [](Vec3 a, Vec3 b, Vec3 c) {
    const double ax = a.x, ay = a.y, az = a.z, bx = b.x, by = b.y, bz = b.z, cx = c.x, cy = c.y, cz = c.z;
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
  };
  const Vec3 a = mesh.vertices_mm[quad[0]];
  return (tetrahedron(a, mesh.vertices_mm[quad[1]], mesh.vertices_mm[quad[2]]) +
          tetrahedron(a, mesh.vertices_mm[quad[2]], mesh.vertices_mm[quad[3]])) /
         6.0;
}

double VolumeOf(const WeldedSurface& mesh) {
  double sum = 0.0;
  for (const auto& quad : mesh.quads) sum += VolumeUnder(mesh, quad);
  return sum;
}

}  // namespace osteon::surface
