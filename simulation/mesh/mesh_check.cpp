#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "simulation/mesh/mesh_bvh.h"
#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {
namespace {

constexpr double kMaxCoordinate_m = 10.0;  // largest distance of a vertex from the origin along any axis
constexpr double kMaxSize_m = 1.0;         // largest side of the box around the mesh
constexpr double kMinVolume_m3 = 1e-9;

constexpr const char* kUnits = "files are read in millimetres, times --scale";

using Problem = std::optional<MeshError>;  // empty: the mesh passes

/// Checks that there are triangles, and that their vertices are finite and of a plausible size.
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
                       fmt::format("{}: vertex {}: found {}, accepted finite coordinates", name, i, InMm(v))};
    if (v.cwiseAbs().maxCoeff() > kMaxCoordinate_m)
      return MeshError{MeshErrorKind::kTooLarge,
                       fmt::format("{}: vertex {}: found {}, accepted within ±{:g} mm", name, i, InMm(v),
                                   kMaxCoordinate_m * 1e3)};
  }
  if (box.sizes().maxCoeff() > kMaxSize_m)
    return MeshError{MeshErrorKind::kTooLarge,
                     fmt::format("{}: found a size of {:.6g} mm, accepted up to {:g} mm ({})", name,
                                 box.sizes().maxCoeff() * 1e3, kMaxSize_m * 1e3, kUnits)};
  return std::nullopt;
}

/// Checks that each edge joins two triangles, which run along it in opposite directions.
Problem CheckEdges(const TriangleMesh& mesh, const std::vector<MeshEdge>& edges, const std::string& name) {
  // the edges that have one kind of defect: how many, and the first edge's index and number of triangles
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
    const MeshEdge& e = edges[f.first];
    return fmt::format("the first of {} from {} to {}", f.count, InMm(mesh.vertices_m[e.low]),
                       InMm(mesh.vertices_m[e.high]));
  };
  if (crowded.count > 0)
    return MeshError{MeshErrorKind::kNonManifold,
                     fmt::format("{}: non-manifold edges, {}: found {} triangles at it (the first is "
                                 "triangle {}), accepted 2",
                                 name, place(crowded), crowded.sides, edges[crowded.first].triangle)};
  if (open.count > 0)
    return MeshError{MeshErrorKind::kOpen,
                     fmt::format("{}: open edges, {}: found triangle {} alone at it, accepted 2 triangles (a "
                                 "closed surface)",
                                 name, place(open), edges[open.first].triangle)};
  if (contrary.count > 0)
    return MeshError{
        MeshErrorKind::kOrientation,
        fmt::format("{}: inconsistent orientation, {}: found triangles {} and {} wound in contrary "
                    "senses, accepted one sense throughout",
                    name, place(contrary), edges[contrary.first].triangle,
                    edges[contrary.first + 1].triangle)};
  return std::nullopt;
}

/// Checks that the triangles around each vertex form one fan. At both ends of an edge, the corners of its two
/// triangles are joined into one set. Each vertex must then have a single set of corners.
Problem CheckVertices(const TriangleMesh& mesh, const std::vector<MeshEdge>& edges, const std::string& name) {
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
          fmt::format(
              "{}: non-manifold vertex at {}: found sheets that meet in this point only (triangles {} "
              "and {}), accepted one fan of triangles around a vertex",
              name, InMm(mesh.vertices_m[v]), fan_of[v] / 3, t)};
    }
  return std::nullopt;
}

/// Checks that no edge passes through a triangle.
Problem CheckCrossings(const PartedMesh& parted, const std::string& name) {
  const auto crossing = MeshBvh(parted.mesh).FindCrossing(kCrossingTolerance_m);
  if (!crossing) return std::nullopt;
  const auto part = [&parted](std::uint32_t triangle) -> std::string {
    if (parted.part_of_triangle.empty() || parted.parts.size() < 2) return "";
    return fmt::format(" of '{}'", parted.parts[parted.part_of_triangle[triangle]]);
  };
  return MeshError{
      MeshErrorKind::kSelfIntersecting,
      fmt::format("{}: self-intersection at {}: found an edge of triangle {}{} through triangle "
                  "{}{}, accepted none deeper than {:g} mm",
                  name, InMm(crossing->p_m), crossing->edge_triangle, part(crossing->edge_triangle),
                  crossing->triangle, part(crossing->triangle), kCrossingTolerance_m * 1e3)};
}

}  // namespace

std::string InMm(const Vector3& p_m) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f}) mm", p_m.x() * 1e3, p_m.y() * 1e3, p_m.z() * 1e3);
}

std::vector<MeshEdge> SortedEdges(const TriangleMesh& mesh) {
  std::vector<MeshEdge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = mesh.triangles[t][k], j = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({.low = std::min(i, j), .high = std::max(i, j), .triangle = t, .rising = i < j});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

double SignedVolume_m3(const TriangleMesh& mesh) {
  // sum relative to the first vertex: far from the origin, large terms would cancel and lose digits
  const Vector3 o = mesh.vertices_m.empty() ? Vector3(Vector3::Zero()) : mesh.vertices_m.front();
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += (mesh.vertices_m[t[0]] - o).dot((mesh.vertices_m[t[1]] - o).cross(mesh.vertices_m[t[2]] - o));
  return sum / 6.0;
}

tl::expected<LoadedMesh, MeshError> AcceptMesh(PartedMesh parted, const MeshReport& so_far,
                                               const std::string& name) {
  MeshReport report = so_far;
  TriangleMesh& mesh = parted.mesh;
  if (auto problem = CheckCoordinates(mesh, name)) return tl::make_unexpected(*problem);
  const std::vector<MeshEdge> edges = SortedEdges(mesh);
  if (auto problem = CheckEdges(mesh, edges, name)) return tl::make_unexpected(*problem);
  if (auto problem = CheckVertices(mesh, edges, name)) return tl::make_unexpected(*problem);

  const double volume = SignedVolume_m3(mesh);
  if (!(std::abs(volume) >= kMinVolume_m3)) {
    Eigen::AlignedBox3d box;
    for (const Vector3& v : mesh.vertices_m) box.extend(v);
    const Vector3 size = box.sizes() * 1e3;
    return tl::make_unexpected(MeshError{
        MeshErrorKind::kNoVolume,
        fmt::format(
            "{}: found a volume of {:.3g} mm^3 in a box of {:.4g} x {:.4g} x {:.4g} mm, accepted {:g} "
            "mm^3 and more ({})",
            name, std::abs(volume) * 1e9, size.x(), size.y(), size.z(), kMinVolume_m3 * 1e9, kUnits)});
  }
  if (volume < 0.0) {
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    report.flipped = true;
  }
  if (auto problem = CheckCrossings(parted, name)) return tl::make_unexpected(*problem);
  return SortShells(std::move(parted), std::move(report), name);
}

tl::expected<MeshReport, MeshError> CheckMesh(TriangleMesh& mesh, const std::string& name) {
  auto accepted = AcceptMesh({.mesh = mesh, .parts = {}, .part_of_triangle = {}}, {}, name);
  if (!accepted) return tl::make_unexpected(accepted.error());
  if (!accepted->regions.empty())
    return tl::make_unexpected(MeshError{
        MeshErrorKind::kContradictory,
        fmt::format("{}: found a shell wound outwards inside another, at {}, accepted inwards (a cavity)",
                    name, InMm(accepted->regions.front().mesh.vertices_m.front()))});
  mesh = std::move(accepted->mesh);
  return accepted->report;
}

}  // namespace osteon::simulation
