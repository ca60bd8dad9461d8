#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <embree3/rtcore.h>

#include "simulation/mesh_bvh.h"

namespace osteon::simulation {
namespace {

// Embree works in float millimetres: files come in these, so their vertices are exact in float.
constexpr double kMm = 1e3;

struct EmbreeMesh {
  RTCDevice device{nullptr};
  RTCScene scene{nullptr};

  explicit EmbreeMesh(const TriangleMesh& mesh);
  ~EmbreeMesh() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  EmbreeMesh(const EmbreeMesh&) = delete;
  EmbreeMesh& operator=(const EmbreeMesh&) = delete;
};

EmbreeMesh::EmbreeMesh(const TriangleMesh& mesh) {
  // one thread: Embree's pool would outlive the set-up, beside a servo loop
  device = rtcNewDevice("threads=1");
  if (!device) throw std::runtime_error("mesh: Embree does not start on this machine");
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_m.size()));
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              mesh.triangles.size()));
  if (!xyz || !corners) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error("mesh: Embree has no memory for the triangles");
  }
  for (const Vector3& v : mesh.vertices_m)
    for (int axis = 0; axis < 3; ++axis) *xyz++ = static_cast<float>(v[axis] * kMm);
  for (const auto& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
}

}  // namespace

std::optional<MeshCrossing> FindCrossing(const TriangleMesh& mesh, double tolerance_m) {
  const EmbreeMesh embree(mesh);
  struct Search {
    RTCIntersectContext context;  // first, so that Embree's pointer to it is one to all of this
    const TriangleMesh* mesh;
    double tolerance_m;
    std::uint32_t edge_triangle;
    std::array<std::uint32_t, 2> edge;
    std::optional<MeshCrossing> crossing;
  };
  // Embree proposes triangles; double arithmetic decides.
  const auto decide = [](const RTCFilterFunctionNArguments* args) {
    auto& s = *reinterpret_cast<Search*>(args->context);
    const std::uint32_t t = RTCHitN_primID(args->hit, args->N, 0);
    args->valid[0] = 0;
    const auto& corners = s.mesh->triangles[t];
    for (const std::uint32_t corner : corners)
      if (corner == s.edge[0] || corner == s.edge[1]) return;
    const Vector3 &a = s.mesh->vertices_m[corners[0]], &b = s.mesh->vertices_m[corners[1]],
                  &c = s.mesh->vertices_m[corners[2]];
    const Vector3 normal = (b - a).cross(c - a).normalized();
    const Vector3 &from = s.mesh->vertices_m[s.edge[0]], &to = s.mesh->vertices_m[s.edge[1]];
    const double before = normal.dot(from - a), after = normal.dot(to - a);
    if (!(std::min(std::abs(before), std::abs(after)) > s.tolerance_m) || before * after > 0.0) return;
    const Vector3 at = from + before / (before - after) * (to - from);
    // how far inside the triangle's border; negative outside
    double inside = std::numeric_limits<double>::infinity();
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      inside = std::min(inside, normal.cross(q - p).normalized().dot(at - p));
    if (!(inside > s.tolerance_m)) return;
    s.crossing = {.p_m = at, .edge_triangle = s.edge_triangle, .triangle = t};
    args->valid[0] = -1;
  };
  Search search{.context = {},
                .mesh = &mesh,
                .tolerance_m = tolerance_m,
                .edge_triangle = 0,
                .edge = {},
                .crossing = {}};
  rtcInitIntersectContext(&search.context);
  search.context.filter = decide;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = mesh.triangles[t][k], j = mesh.triangles[t][(k + 1) % 3];
      if (i > j) continue;  // the neighbour's turn: each edge is walked both ways
      search.edge_triangle = t;
      search.edge = {i, j};
      const Vector3 from = mesh.vertices_m[i] * kMm, way = (mesh.vertices_m[j] * kMm) - from;
      alignas(16) RTCRay ray{};
      ray.org_x = static_cast<float>(from.x());
      ray.org_y = static_cast<float>(from.y());
      ray.org_z = static_cast<float>(from.z());
      ray.dir_x = static_cast<float>(way.x());
      ray.dir_y = static_cast<float>(way.y());
      ray.dir_z = static_cast<float>(way.z());
      ray.tfar = 1.0f;
      ray.mask = ~0u;
      rtcOccluded1(embree.scene, &search.context, &ray);
      if (search.crossing) return search.crossing;
    }
  }
  return std::nullopt;
}

}  // namespace osteon::simulation
