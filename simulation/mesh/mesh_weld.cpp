#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {
namespace {

/// Hash of a vertex's coordinates.
struct PlaceHash {
  std::size_t operator()(const std::array<float, 3>& p) const {
    std::size_t hash = 0;
    for (const float x : p) hash = hash * 1000003 + std::hash<float>{}(x);
    return hash;
  }
};

/// Drops triangles with two corners in one place. If several triangles of one part have the same corners and
/// winding, only the first is kept.
void DropCollapsed(PartedMesh& parted, MeshReport& report) {
  // after sorting, triangles with the same corners and winding stand next to each other
  struct Turned {
    std::uint32_t part;
    std::array<std::uint32_t, 3> corners;  // cyclically shifted, so that the lowest index comes first
    std::size_t triangle;
    auto operator<=>(const Turned&) const = default;
  };
  auto& triangles = parted.mesh.triangles;
  std::vector<Turned> turned(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<std::uint32_t, 3> t = triangles[i];
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    turned[i] = {.part = parted.part_of_triangle[i], .corners = t, .triangle = i};
  }
  std::sort(turned.begin(), turned.end());
  std::vector<bool> keep(triangles.size(), true);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const auto& [a, b, c] = turned[i].corners;
    if (a == b || b == c || c == a) {
      keep[turned[i].triangle] = false;
      ++report.dropped_triangles;
    } else if (i > 0 && turned[i].part == turned[i - 1].part && turned[i].corners == turned[i - 1].corners) {
      keep[turned[i].triangle] = false;
      ++report.duplicate_triangles;
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!keep[i]) continue;
    triangles[kept] = triangles[i];
    parted.part_of_triangle[kept++] = parted.part_of_triangle[i];
  }
  triangles.resize(kept);
  parted.part_of_triangle.resize(kept);
}

/// Ends of edges that have only one triangle, ascending.
std::vector<std::uint32_t> OpenEnds(const TriangleMesh& mesh) {
  const std::vector<MeshEdge> edges = SortedEdges(mesh);
  std::vector<std::uint32_t> ends;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto same = [&](std::size_t k) {
      return k < edges.size() && edges[k].low == edges[i].low && edges[k].high == edges[i].high;
    };
    if (!same(i + 1) && !(i > 0 && same(i - 1))) ends.insert(ends.end(), {edges[i].low, edges[i].high});
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

}  // namespace

PartedMesh WeldParts(const RawMesh& raw, double m_per_unit, MeshReport& report) {
  PartedMesh parted{.mesh = {}, .parts = raw.parts, .part_of_triangle = raw.part_of_triangle};
  std::vector<std::unordered_map<std::array<float, 3>, std::uint32_t, PlaceHash>> welded(raw.parts.size());
  for (std::size_t i = 0; i < raw.triangles.size(); ++i) {
    std::array<std::uint32_t, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      const std::array<float, 3>& place = raw.triangles[i][k];
      const auto [at, is_new] = welded[raw.part_of_triangle[i]].try_emplace(
          place, static_cast<std::uint32_t>(parted.mesh.vertices_m.size()));
      if (is_new) parted.mesh.vertices_m.push_back(Vector3(place[0], place[1], place[2]) * m_per_unit);
      triangle[k] = at->second;
    }
    parted.mesh.triangles.push_back(triangle);
  }
  DropCollapsed(parted, report);
  return parted;
}

std::size_t WeldOpenEdges(PartedMesh& parted, double tolerance_m, MeshReport& report) {
  TriangleMesh& mesh = parted.mesh;
  const std::vector<std::uint32_t> ends = OpenEnds(mesh);
  // in a list that is sorted along x, ends within the tolerance of each other are close
  std::vector<std::uint32_t> along = ends;
  std::sort(along.begin(), along.end(), [&mesh](std::uint32_t i, std::uint32_t j) {
    const double x = mesh.vertices_m[i].x(), y = mesh.vertices_m[j].x();
    return x < y || (x == y && i < j);
  });
  DisjointSets sets(mesh.vertices_m.size());
  for (std::size_t i = 0; i < along.size(); ++i)
    for (std::size_t k = i + 1; k < along.size(); ++k) {
      const Vector3 d = mesh.vertices_m[along[k]] - mesh.vertices_m[along[i]];
      if (d.x() > tolerance_m) break;
      if (d.norm() <= tolerance_m) sets.Join(along[i], along[k]);
    }
  std::size_t gone = 0;
  for (const std::uint32_t i : ends) gone += sets.Find(i) != i ? 1 : 0;
  if (gone == 0) return 0;
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) corner = sets.Find(corner);
  DropCollapsed(parted, report);
  return gone;
}

}  // namespace osteon::simulation
