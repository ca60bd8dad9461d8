#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "simulation/mesh_bvh.h"
#include "simulation/triangle_mesh.h"

namespace osteon::simulation {
namespace {

constexpr double kLargestCoordinate_m = 10.0;
constexpr double kLargestSize_m = 1.0;
constexpr double kLeastVolume_m3 = 1e-9;
constexpr double kCrossingTolerance_m = 1e-5;
constexpr std::size_t kMostShells = 64;

using Problem = std::optional<MeshError>;

std::string Mm(const Vector3& p) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f}) mm", p.x() * 1e3, p.y() * 1e3, p.z() * 1e3);
}

struct Edge {
  std::uint32_t low, high, triangle;
  bool rising;  ///< the triangle walks it from low to high
  auto operator<=>(const Edge&) const = default;
};

std::vector<Edge> SortedEdges(const TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = mesh.triangles[t][k], j = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({.low = std::min(i, j), .high = std::max(i, j), .triangle = t, .rising = i < j});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

Problem CheckCoordinates(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.triangles.empty())
    return MeshError{MeshErrorKind::kEmpty,
                     fmt::format("{}: found no triangles, accepted a closed surface", name)};
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < mesh.vertices_m.size(); ++i) {
    const Vector3& v = mesh.vertices_m[i];
    box.extend(v);
    if (!v.allFinite())
      return MeshError{MeshErrorKind::kNotFinite,
                       fmt::format("{}: vertex {}: found {}, accepted finite coordinates", name, i, Mm(v))};
    if (v.cwiseAbs().maxCoeff() > kLargestCoordinate_m)
      return MeshError{MeshErrorKind::kTooLarge,
                       fmt::format("{}: vertex {}: found {}, accepted within ±{:g} mm", name, i, Mm(v),
                                   kLargestCoordinate_m * 1e3)};
  }
  if (box.sizes().maxCoeff() > kLargestSize_m)
    return MeshError{
        MeshErrorKind::kTooLarge,
        fmt::format("{}: found a size of {:.6g} mm, accepted up to {:g} mm (files are read in millimetres)",
                    name, box.sizes().maxCoeff() * 1e3, kLargestSize_m * 1e3)};
  return std::nullopt;
}

/// Each edge joins two triangles, which walk it in opposite directions.
Problem CheckEdges(const TriangleMesh& mesh, const std::vector<Edge>& edges, const std::string& name) {
  struct Finding {
    std::size_t count{0}, first{0}, sides{0};
  };
  Finding open, crowded, contrary;
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    const std::size_t sides = end - i;
    Finding* finding = nullptr;
    if (sides == 1) finding = &open;
    if (sides > 2) finding = &crowded;
    if (sides == 2 && edges[i].rising == edges[i + 1].rising) finding = &contrary;
    if (finding && finding->count++ == 0) *finding = {.count = 1, .first = i, .sides = sides};
    i = end;
  }
  const auto place = [&](const Finding& f) {
    const Edge& e = edges[f.first];
    return fmt::format("the first of {} from {} to {}", f.count, Mm(mesh.vertices_m[e.low]),
                       Mm(mesh.vertices_m[e.high]));
  };
  if (crowded.count > 0)
    return MeshError{MeshErrorKind::kNonManifold,
                     fmt::format("{}: non-manifold edges, {}: found {} triangles at it, accepted 2", name,
                                 place(crowded), crowded.sides)};
  if (open.count > 0)
    return MeshError{MeshErrorKind::kOpen,
                     fmt::format("{}: open edges, {}: found 1 triangle at it, accepted 2 (a closed surface)",
                                 name, place(open))};
  if (contrary.count > 0)
    return MeshError{
        MeshErrorKind::kOrientation,
        fmt::format("{}: inconsistent orientation, {}: found triangles {} and {} wound in contrary "
                    "senses, accepted one sense throughout",
                    name, place(contrary), edges[contrary.first].triangle,
                    edges[contrary.first + 1].triangle)};
  return std::nullopt;
}

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t Find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(std::uint32_t i, std::uint32_t j) {
    parent_[std::max(Find(i), Find(j))] = std::min(Find(i), Find(j));
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The triangles around each vertex form one fan. On corners: those of a fan are joined across its edges.
Problem CheckVertices(const TriangleMesh& mesh, const std::vector<Edge>& edges, const std::string& name) {
  const auto corner = [&mesh](std::uint32_t triangle, std::uint32_t vertex) {
    const auto& t = mesh.triangles[triangle];
    return 3 * triangle + static_cast<std::uint32_t>(std::find(t.begin(), t.end(), vertex) - t.begin());
  };
  DisjointSets fans(3 * mesh.triangles.size());
  for (std::size_t i = 0; i + 1 < edges.size(); i += 2)
    for (const std::uint32_t v : {edges[i].low, edges[i].high})
      fans.Join(corner(edges[i].triangle, v), corner(edges[i + 1].triangle, v));
  std::vector<std::int64_t> fan_of(mesh.vertices_m.size(), -1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k], fan = fans.Find(3 * t + k);
      if (fan_of[v] < 0) fan_of[v] = fan;
      if (fan_of[v] == fan) continue;
      return MeshError{
          MeshErrorKind::kNonManifold,
          fmt::format("{}: non-manifold vertex at {}: found sheets that meet in this point only, accepted "
                      "one fan of triangles around a vertex",
                      name, Mm(mesh.vertices_m[v]))};
    }
  return std::nullopt;
}

/// How often the surface winds around p. Solid angles: Van Oosterom, Strackee, IEEE Trans. Biomed. Eng. 30,
/// 1983.
double WindingNumber(const TriangleMesh& mesh, const Vector3& p) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3 a = mesh.vertices_m[t[0]] - p, b = mesh.vertices_m[t[1]] - p, c = mesh.vertices_m[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2.0 * std::numbers::pi);
}

/// Bone on the inner side of every shell, none on the outer: winding numbers 1 and 0 on both sides of one
/// triangle of it.
Problem CheckShells(const TriangleMesh& mesh, const std::string& name, std::size_t& shell_count) {
  DisjointSets sets(mesh.vertices_m.size());
  for (const auto& t : mesh.triangles) {
    sets.Join(t[0], t[1]);
    sets.Join(t[1], t[2]);
  }
  const auto area_vector = [&mesh](const std::array<std::uint32_t, 3>& t) -> Vector3 {
    const Vector3& a = mesh.vertices_m[t[0]];
    return 0.5 * (mesh.vertices_m[t[1]] - a).cross(mesh.vertices_m[t[2]] - a);
  };
  // the largest triangle of each shell, found by the shell's first vertex
  std::vector<std::int64_t> largest(mesh.vertices_m.size(), -1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    std::int64_t& best = largest[sets.Find(mesh.triangles[i][0])];
    if (best < 0 || area_vector(mesh.triangles[i]).norm() > area_vector(mesh.triangles[best]).norm())
      best = static_cast<std::int64_t>(i);
  }
  std::erase(largest, -1);
  shell_count = largest.size();
  if (shell_count > kMostShells)
    return MeshError{MeshErrorKind::kContradictory,
                     fmt::format("{}: found {} separate shells, accepted 1 … {} (remove the islands)", name,
                                 shell_count, kMostShells)};
  for (const std::int64_t i : largest) {
    const auto& t = mesh.triangles[i];
    const Vector3 area = area_vector(t);
    const Vector3 center = (mesh.vertices_m[t[0]] + mesh.vertices_m[t[1]] + mesh.vertices_m[t[2]]) / 3.0;
    const Vector3 step = 1e-5 * std::sqrt(area.norm()) * area.normalized();
    const double outside = WindingNumber(mesh, center + step), inside = WindingNumber(mesh, center - step);
    if (std::abs(outside) < 0.1 && std::abs(inside - 1.0) < 0.1) continue;
    return MeshError{
        MeshErrorKind::kContradictory,
        fmt::format("{}: contradictory shells at {}: found the surface wound {:.0f} times around its outer "
                    "side and {:.0f} times around its inner side, accepted 0 and 1 (a shell inside another "
                    "is a cavity, wound inwards)",
                    name, Mm(center), std::round(outside), std::round(inside))};
  }
  return std::nullopt;
}

}  // namespace

double SignedVolume_m3(const TriangleMesh& mesh) {
  // about the first vertex: far from the origin, large terms would cancel
  const Vector3 o = mesh.vertices_m.empty() ? Vector3(Vector3::Zero()) : mesh.vertices_m.front();
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += (mesh.vertices_m[t[0]] - o).dot((mesh.vertices_m[t[1]] - o).cross(mesh.vertices_m[t[2]] - o));
  return sum / 6.0;
}

tl::expected<MeshReport, MeshError> CheckMesh(TriangleMesh& mesh, const std::string& name) {
  MeshReport report;
  if (auto problem = CheckCoordinates(mesh, name)) return tl::make_unexpected(*problem);
  const std::vector<Edge> edges = SortedEdges(mesh);
  if (auto problem = CheckEdges(mesh, edges, name)) return tl::make_unexpected(*problem);
  if (auto problem = CheckVertices(mesh, edges, name)) return tl::make_unexpected(*problem);

  const double volume = SignedVolume_m3(mesh);
  if (!(std::abs(volume) >= kLeastVolume_m3)) {
    Eigen::AlignedBox3d box;
    for (const Vector3& v : mesh.vertices_m) box.extend(v);
    const Vector3 size = box.sizes() * 1e3;
    return tl::make_unexpected(MeshError{
        MeshErrorKind::kNoVolume,
        fmt::format("{}: found a volume of {:.3g} mm^3 in a box of {:.4g} x {:.4g} x {:.4g} mm, accepted "
                    "{:g} mm^3 and "
                    "more (files are read in millimetres)",
                    name, std::abs(volume) * 1e9, size.x(), size.y(), size.z(), kLeastVolume_m3 * 1e9)});
  }
  if (volume < 0.0) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    report.flipped = true;
  }
  if (const auto crossing = MeshBvh(mesh).FindCrossing(kCrossingTolerance_m))
    return tl::make_unexpected(MeshError{MeshErrorKind::kSelfIntersecting,
                                         fmt::format("{}: self-intersection at {}: found an edge of triangle "
                                                     "{} through triangle {}, accepted none deeper "
                                                     "than {:g} mm",
                                                     name, Mm(crossing->p_m), crossing->edge_triangle,
                                                     crossing->triangle, kCrossingTolerance_m * 1e3)});
  if (auto problem = CheckShells(mesh, name, report.shells)) return tl::make_unexpected(*problem);
  return report;
}

}  // namespace osteon::simulation
