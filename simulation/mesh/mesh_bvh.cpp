#include "simulation/mesh/mesh_bvh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <embree3/rtcore.h>

#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {
namespace {

// Embree works in float millimetres: mesh files use them, so their vertices are exact in float.
constexpr double kMm = 1e3;

struct Feature {
  Vector3 p;
  TriangleFeature feature;
};

/// Nearest point of a triangle. Source: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
Feature NearestOnTriangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, TriangleFeature::kCorner0};
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, TriangleFeature::kCorner1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + d1 / (d1 - d3) * ab, TriangleFeature::kEdge0};
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, TriangleFeature::kCorner2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + d2 / (d2 - d6) * ac, TriangleFeature::kEdge2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), TriangleFeature::kEdge1};
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return {a, TriangleFeature::kCorner0};  // a sliver; its neighbours' edges are as near
  return {a + vb / sum * ab + vc / sum * ac, TriangleFeature::kFace};
}

}  // namespace

struct MeshBvh::Impl {
  TriangleMesh mesh;
  double slack_m{0.0};  ///< bound on a point's displacement by rounding to float, with a margin
  RTCDevice device{nullptr};
  RTCScene scene{nullptr};

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  [[nodiscard]] const Vector3& Corner(std::uint32_t triangle, int k) const {
    return mesh.vertices_m[mesh.triangles[triangle][k]];
  }
};

MeshBvh::MeshBvh(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  impl_->mesh = mesh;
  // one thread: Embree's pool would outlive the set-up and run beside a servo loop
  impl_->device = rtcNewDevice("threads=1");
  if (!impl_->device) throw std::runtime_error("mesh: Embree does not start on this machine");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* xyz = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices_m.size()));
  auto* corners = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              mesh.triangles.size()));
  if (!xyz || !corners) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error("mesh: Embree has no memory for the triangles");
  }
  double largest_m = 0.0;
  for (const Vector3& v : mesh.vertices_m) {
    largest_m = std::max(largest_m, v.cwiseAbs().maxCoeff());
    for (int axis = 0; axis < 3; ++axis) *xyz++ = static_cast<float>(v[axis] * kMm);
  }
  for (const auto& triangle : mesh.triangles) corners = std::copy(triangle.begin(), triangle.end(), corners);
  impl_->slack_m = 8.0 * std::numeric_limits<float>::epsilon() * largest_m;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
}

MeshBvh::~MeshBvh() = default;

TriangleHit MeshBvh::Nearest(const Vector3& p_m) const {
  struct Search {
    const Impl& impl;
    Vector3 p;
    double slack_m;
    TriangleHit hit;

    /// Takes the triangle if it is nearer than all before; among equally near ones the first of the mesh
    /// counts.
    bool Take(std::uint32_t t) {
      const Feature nearest = NearestOnTriangle(p, impl.Corner(t, 0), impl.Corner(t, 1), impl.Corner(t, 2));
      const double distance = (p - nearest.p).norm();
      if (!(distance < hit.distance_m || (distance == hit.distance_m && t < hit.triangle))) return false;
      hit = {.p_m = nearest.p, .distance_m = distance, .triangle = t, .feature = nearest.feature};
      return true;
    }
    /// Radius [mm] within which Embree finds every triangle that may be nearer.
    [[nodiscard]] float Radius() const {
      return static_cast<float>((hit.distance_m + slack_m) * (1.0 + 1e-6) * kMm);
    }
  };
  // the query point is rounded as well, in proportion to its coordinates
  const double slack =
      impl_->slack_m + 8.0 * std::numeric_limits<float>::epsilon() * p_m.cwiseAbs().maxCoeff();
  Search search{.impl = *impl_, .p = p_m, .slack_m = slack, .hit = {}};
  search.hit.distance_m = std::numeric_limits<double>::infinity();
  // The triangle that the thread found last bounds the search: most queries are near the one before. Any
  // triangle gives the same result.
  thread_local std::uint32_t last = 0;
  if (last < impl_->mesh.triangles.size()) search.Take(last);
  const auto visit = [](RTCPointQueryFunctionArguments* args) -> bool {
    auto& s = *static_cast<Search*>(args->userPtr);
    if (!s.Take(args->primID)) return false;
    args->query->radius = s.Radius();
    return true;
  };
  alignas(16) RTCPointQuery query{.x = static_cast<float>(p_m.x() * kMm),
                                  .y = static_cast<float>(p_m.y() * kMm),
                                  .z = static_cast<float>(p_m.z() * kMm),
                                  .time = 0.0f,
                                  .radius = search.Radius()};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, visit, &search);
  last = search.hit.triangle;
  return search.hit;
}

std::optional<MeshCrossing> MeshBvh::CrossingOf(std::uint32_t triangle,
                                                const std::array<std::uint32_t, 2>& edge,
                                                double tolerance_m) const {
  struct Search {
    RTCIntersectContext context;  // first, so that Embree's pointer to it points to this struct, too
    const Impl* impl;
    double tolerance_m;
    std::uint32_t edge_triangle;
    std::array<std::uint32_t, 2> edge;
    std::optional<MeshCrossing> crossing;
  };
  // Embree proposes triangles; double precision decides.
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
  rtcOccluded1(impl_->scene, &search.context, &ray);
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
