#include "simulation/solids/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace osteon::simulation {
namespace {

// True if part of a tissue may consist of this material.
bool Mentions(const LiningTissue& tissue, MaterialIndex material) {
  return tissue.core == material || std::ranges::any_of(tissue.layers, [material](const TissueLayer& layer) {
           return layer.material == material;
         });
}

bool Mentions(const ShellTissue& tissue, MaterialIndex material) {
  const auto is_it = [material](const auto& part) { return part.material == material; };
  return tissue.core == material || std::ranges::any_of(tissue.layers, is_it) ||
         (tissue.image && std::ranges::any_of(tissue.image->classes, is_it));
}

}  // namespace

MeshDistance::MeshDistance(const TriangleMesh& mesh)
    : bvh_(mesh),
      face_normals_(mesh.triangles.size()),
      edge_normals_(3 * mesh.triangles.size()),
      corner_normals_(3 * mesh.triangles.size()) {
  for (const Vector3& v : mesh.vertices_m) box_.extend(v);
  std::vector<Vector3> corner_normals(mesh.vertices_m.size(), Vector3::Zero());
  using EdgeEnds = std::pair<std::uint32_t, std::uint32_t>;
  std::map<EdgeEnds, Vector3> edge_normals;
  // the two vertices of a triangle's k-th edge, the smaller index first
  const auto edge = [&mesh](std::size_t t, int k) -> EdgeEnds {
    const std::uint32_t i = mesh.triangles[t][k], j = mesh.triangles[t][(k + 1) % 3];
    return std::minmax(i, j);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vector3, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = mesh.vertices_m[mesh.triangles[t][k]];
    // zero if the triangle has no area
    const Vector3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    face_normals_[t] = normal;
    for (int k = 0; k < 3; ++k) {
      edge_normals.try_emplace(edge(t, k), Vector3::Zero()).first->second += normal;
      const Vector3 to_next = p[(k + 1) % 3] - p[k], to_last = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
      corner_normals[mesh.triangles[t][k]] += angle * normal;
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      edge_normals_[3 * t + k] = edge_normals.at(edge(t, k));
      corner_normals_[3 * t + k] = corner_normals[mesh.triangles[t][k]];
    }
}

MeshDistance::Point MeshDistance::Nearest(const Vector3& p_m) const {
  Point point{.hit = bvh_.Nearest(p_m)};
  const std::size_t t = point.hit.triangle;
  const auto feature = static_cast<std::size_t>(point.hit.feature);
  constexpr auto kEdge = static_cast<std::size_t>(TriangleFeature::kEdge0);
  constexpr auto kCorner = static_cast<std::size_t>(TriangleFeature::kCorner0);
  point.normal = feature >= kCorner ? corner_normals_[3 * t + feature - kCorner]
                 : feature >= kEdge ? edge_normals_[3 * t + feature - kEdge]
                                    : face_normals_[t];
  point.distance_m =
      point.normal.dot(p_m - point.hit.p_m) < 0.0 ? -point.hit.distance_m : point.hit.distance_m;
  return point;
}

MeshSolid::MeshSolid(const LoadedMesh& loaded, TissueMap tissue)
    : boundary_(loaded.mesh), tissue_(std::move(tissue)) {
  for (const MeshRegion& region : loaded.regions)
    regions_.push_back(std::make_unique<MeshDistance>(region.mesh));
}

MeshSolid::MeshSolid(const TriangleMesh& mesh, TissueMap tissue)
    : boundary_(mesh), tissue_(std::move(tissue)) {}

const ShellTissue& MeshSolid::Tissue(std::size_t shell) const {
  return tissue_.shells[std::min(shell, tissue_.shells.size() - 1)];
}

SurfacePoint MeshSolid::NearestSurface(const Vector3& p_m) const {
  const MeshDistance::Point nearest = boundary_.Nearest(p_m);
  return {.p_m = nearest.hit.p_m, .distance_m = nearest.distance_m};
}

std::optional<SurfacePoint> MeshSolid::RegionDistance(MaterialIndex material, const Vector3& p_m) const {
  if (Mentions(Tissue(0), material) || (tissue_.lining && Mentions(*tissue_.lining, material)))
    return std::nullopt;
  std::optional<SurfacePoint> nearest;
  for (std::size_t i = 0; i < regions_.size(); ++i) {
    const ShellTissue& tissue = Tissue(i + 1);
    if (!Mentions(tissue, material)) continue;
    if (!tissue.IsUniform()) return std::nullopt;
    const MeshDistance::Point point = regions_[i]->Nearest(p_m);
    if (!nearest || point.distance_m < nearest->distance_m)
      nearest = SurfacePoint{.p_m = point.hit.p_m, .distance_m = point.distance_m};
  }
  return nearest;
}

MaterialIndex MeshSolid::MaterialAt(const Vector3& p_m) const {
  for (std::size_t i = regions_.size(); i-- > 0;) {
    if (!regions_[i]->bounds().contains(p_m)) continue;
    const double distance = regions_[i]->Nearest(p_m).distance_m;
    if (distance < 0.0) return Tissue(i + 1).MaterialAt(-distance, p_m);
  }
  const ShellTissue& shell = Tissue(0);
  if (shell.IsUniform() && !tissue_.lining) return shell.core;
  const MeshDistance::Point nearest = boundary_.Nearest(p_m);
  const double depth = std::max(0.0, -nearest.distance_m);
  if (tissue_.lining && tissue_.lining->Covers(nearest.hit.p_m, nearest.normal))
    return tissue_.lining->MaterialAt(depth);
  return shell.MaterialAt(depth, p_m);
}

}  // namespace osteon::simulation
