#include "simulation/mesh/mesh_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include <embree3/rtcore.h>

#include "simulation/mesh/mesh_steps.h"
#include "simulation/mesh/triangle_tree.h"

namespace osteon::simulation {
namespace {

// Embree gets millimetres in float: most mesh files have this unit, so that their vertices are exact in
// float.
constexpr double kMm = 1e3;  // [mm/m]

/// The triangles for Embree's rays.
class EmbreeScene {
 public:
  explicit EmbreeScene(const TriangleMesh& mesh) {
    // one thread: a pool of Embree's would still be there after the set-up, and run beside a servo loop
    device_.reset(rtcNewDevice("threads=1"));
    if (!device_) throw std::runtime_error("mesh: Embree does not start on this machine");
    scene_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_m.size()));
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    if (!xyz || !corners) {
      rtcReleaseGeometry(geometry);
      throw std::runtime_error("mesh: Embree has no memory for the triangles");
    }
    for (const Vector3& v : mesh.vertices_m)
      for (int axis = 0; axis < 3; ++axis) *xyz++ = static_cast<float>(v[axis] * kMm);
    for (const auto& triangle : mesh.triangles)
      corners = std::copy(triangle.begin(), triangle.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }
  [[nodiscard]] RTCScene get() const { return scene_.get(); }

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace

struct MeshBvh::Impl {
  TriangleMesh mesh;
  TriangleTree tree;
  std::once_flag once;
  /// Made by the first search for crossings; most meshes need no such search
  std::optional<EmbreeScene> scene;

  explicit Impl(const TriangleMesh& from) : mesh(from), tree(mesh) {}
  [[nodiscard]] RTCScene Scene() {
    std::call_once(once, [this] { scene.emplace(mesh); });
    return scene->get();
  }
  [[nodiscard]] const Vector3& Corner(std::uint32_t triangle, int k) const {
    return mesh.vertices_m[mesh.triangles[triangle][k]];
  }
};

MeshBvh::MeshBvh(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {}

MeshBvh::~MeshBvh() = default;

TriangleHit MeshBvh::Nearest(const Vector3& p_m) const { return impl_->tree.Nearest(p_m); }

std::optional<MeshCrossing> MeshBvh::CrossingOf(std::uint32_t triangle,
                                                const std::array<std::uint32_t, 2>& edge,
                                                double tolerance_m) const {
  struct Search {
    RTCIntersectContext context;  // first member: Embree's pointer to it also points to this struct
    const Impl* impl;
    double tolerance_m;
    std::uint32_t edge_triangle;
    std::array<std::uint32_t, 2> edge;
    std::optional<MeshCrossing> crossing;
  };
  // Embree calls this function for each triangle that the edge may pierce. The test is repeated in double
  // precision: the crossing must be farther than the tolerance from the edge's ends and, inside the triangle,
  // from its border.
  const auto decide = [](const RTCFilterFunctionNArguments* args) {
    auto& s = *reinterpret_cast<Search*>(args->context);
    const std::uint32_t t = RTCHitN_primID(args->hit, args->N, 0);
    args->valid[0] = 0;
    const auto& corners = s.impl->mesh.triangles[t];
    for (const std::uint32_t corner : corners)
      if (corner == s.edge[0] || corner == s.edge[1]) return;
    const Vector3 &a = s.impl->Corner(t, 0), &b = s.impl->Corner(t, 1), &c = s.impl->Corner(t, 2);
    const Vector3 normal = (b - a).cross(c - a).normalized();
    const Vector3 &from = s.impl->mesh.vertices_m[s.edge[0]], &to = s.impl->mesh.vertices_m[s.edge[1]];
    const double before = normal.dot(from - a), after = normal.dot(to - a);
    if (!(std::min(std::abs(before), std::abs(after)) > s.tolerance_m) || before * after > 0.0) return;
    const Vector3 at = from + before / (before - after) * (to - from);
    // distance inside the triangle's border; negative outside
    double inside = std::numeric_limits<double>::infinity();
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      inside = std::min(inside, normal.cross(q - p).normalized().dot(at - p));
    if (!(inside > s.tolerance_m)) return;
    s.crossing = {.p_m = at, .edge_triangle = s.edge_triangle, .triangle = t};
    args->valid[0] = -1;
  };
  Search search{.context = {},
                .impl = impl_.get(),
                .tolerance_m = tolerance_m,
                .edge_triangle = triangle,
                .edge = edge,
                .crossing = {}};
  rtcInitIntersectContext(&search.context);
  search.context.filter = decide;
  const Vector3 from = impl_->mesh.vertices_m[edge[0]] * kMm,
                way = (impl_->mesh.vertices_m[edge[1]] * kMm) - from;
  alignas(16) RTCRay ray{};
  ray.org_x = static_cast<float>(from.x());
  ray.org_y = static_cast<float>(from.y());
  ray.org_z = static_cast<float>(from.z());
  ray.dir_x = static_cast<float>(way.x());
  ray.dir_y = static_cast<float>(way.y());
  ray.dir_z = static_cast<float>(way.z());
  ray.tfar = 1.0f;
  ray.mask = ~0u;
  rtcOccluded1(impl_->Scene(), &search.context, &ray);
  return search.crossing;
}

std::optional<MeshCrossing> MeshBvh::FindCrossing(double tolerance_m) const {
  for (std::uint32_t t = 0; t < impl_->mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = impl_->mesh.triangles[t][k], j = impl_->mesh.triangles[t][(k + 1) % 3];
      if (i > j) continue;  // each edge occurs twice, in both directions: use one
      if (const auto crossing = CrossingOf(t, {i, j}, tolerance_m)) return crossing;
    }
  return std::nullopt;
}

std::size_t MeshBvh::CountCrossings(double tolerance_m) const {
  std::size_t count = 0;
  const std::vector<MeshEdge> edges = SortedEdges(impl_->mesh);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const MeshEdge& edge = edges[i];
    if (i > 0 && edges[i - 1].low == edge.low && edges[i - 1].high == edge.high) continue;
    count += CrossingOf(edge.triangle, {edge.low, edge.high}, tolerance_m) ? 1 : 0;
  }
  return count;
}

}  // namespace osteon::simulation
