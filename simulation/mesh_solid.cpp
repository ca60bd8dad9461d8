#include "simulation/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace osteon::simulation {

MeshSolid::MeshSolid(const TriangleMesh& mesh, const Cup& cup, const MeshTissue& tissue)
    : cup_(cup), bvh_(mesh), tissue_(tissue), triangles_(mesh.triangles.size()) {
  for (const Vector3& v : mesh.vertices_m) box_.extend(v);
  std::vector<Vector3> corner_normals(mesh.vertices_m.size(), Vector3::Zero());
  using EdgeEnds = std::pair<std::uint32_t, std::uint32_t>;
  std::map<EdgeEnds, Vector3> edge_normals;
  const auto edge = [&mesh](std::size_t t, int k) -> EdgeEnds {
    const std::uint32_t i = mesh.triangles[t][k], j = mesh.triangles[t][(k + 1) % 3];
    return std::minmax(i, j);
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vector3, 3> p;
    for (int k = 0; k < 3; ++k) p[k] = mesh.vertices_m[mesh.triangles[t][k]];
    const Vector3 normal =
        (p[1] - p[0]).cross(p[2] - p[0]).normalized();  // zero where the triangle is a needle
    triangles_[t].face_normal = normal;
    for (int k = 0; k < 3; ++k) {
      edge_normals.try_emplace(edge(t, k), Vector3::Zero()).first->second += normal;
      const Vector3 to_next = p[(k + 1) % 3] - p[k], to_last = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
      corner_normals[mesh.triangles[t][k]] += angle * normal;
    }
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      triangles_[t].edge_normals[k] = edge_normals.at(edge(t, k));
      triangles_[t].corner_normals[k] = corner_normals[mesh.triangles[t][k]];
    }
}

const Vector3& MeshSolid::NormalAt(const TriangleHit& hit) const {
  const Triangle& t = triangles_[hit.triangle];
  const auto feature = static_cast<int>(hit.feature);
  if (feature >= static_cast<int>(TriangleFeature::kCorner0))
    return t.corner_normals[feature - static_cast<int>(TriangleFeature::kCorner0)];
  if (feature >= static_cast<int>(TriangleFeature::kEdge0))
    return t.edge_normals[feature - static_cast<int>(TriangleFeature::kEdge0)];
  return t.face_normal;
}

double MeshSolid::Signed(const Vector3& p_m, const TriangleHit& hit) const {
  return NormalAt(hit).dot(p_m - hit.p_m) < 0.0 ? -hit.distance_m : hit.distance_m;
}

SurfacePoint MeshSolid::NearestSurface(const Vector3& p_m) const {
  const TriangleHit hit = bvh_.Nearest(p_m);
  return {.p_m = hit.p_m, .distance_m = Signed(p_m, hit)};
}

MaterialIndex MeshSolid::MaterialAt(const Vector3& p_m) const {
  const TriangleHit hit = bvh_.Nearest(p_m);
  const double depth = std::max(0.0, -Signed(p_m, hit));
  const Vector3 from_center = hit.p_m - Vector3(cup_.center_m);
  const bool lining = from_center.norm() <= tissue_.lining_radii * cup_.radius_m &&
                      from_center.dot(Vector3(cup_.axis)) <= 0.0 && NormalAt(hit).dot(from_center) < 0.0;
  if (!lining) return depth < tissue_.cortical_m ? kCortical : kCancellous;
  if (depth < tissue_.cartilage_m) return kCartilage;
  return depth < tissue_.cartilage_m + tissue_.subchondral_m ? kCortical : kCancellous;
}

}  // namespace osteon::simulation
