#include "simulation/mesh_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace osteon::simulation {
namespace {

// The tree works in float millimetres from the mesh's middle.
constexpr double kMm = 1e3;
constexpr std::size_t kMostCandidates = 32;
constexpr int kWidth = 4;  // children of a node, triangles of a leaf: one SIMD register
using Lanes = Eigen::Array<float, kWidth, 1>;

struct Lanes3 {
  Lanes x, y, z;
  void Set(int lane, const Eigen::Vector3f& p) {
    x[lane] = p.x();
    y[lane] = p.y();
    z[lane] = p.z();
  }
};

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

// Inlined by force: as calls, they would pass registers through memory (half of the search's time).
[[gnu::always_inline]] inline Lanes Dot(const Lanes3& a, const Lanes3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[gnu::always_inline]] inline Lanes3 Minus(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[gnu::always_inline]] inline Lanes3 Cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

constexpr float kTiny = 1e-30f;  // keeps the 0 / 0 of an edge without length away

/// What one edge says of the distances: from is the point, from the edge's beginning.
struct EdgeView {
  Lanes distance2, side;
};
[[gnu::always_inline]] inline EdgeView View(const Lanes3& from, const Lanes3& edge, const Lanes3& normal) {
  const Lanes along = (Dot(from, edge) / (Dot(edge, edge) + kTiny)).max(0.0f).min(1.0f);
  const Lanes3 off{from.x - along * edge.x, from.y - along * edge.y, from.z - along * edge.z};
  return {.distance2 = Dot(off, off), .side = Dot(Cross(normal, edge), from)};
}

/// Four triangles for a quick look. Edges are not stored: memory is what a search waits for. Normals are: in
/// floats, a needle's corners no longer tell its plane. Fewer: the last is there again.
struct Leaf {
  Lanes3 a, b, c, normal;  // unit, or zero
  std::array<std::uint32_t, kWidth> triangle;

  /// Squared distances from p, by float rounding off.
  [[gnu::always_inline]] [[nodiscard]] Lanes SquaredDistances(const Lanes3& p) const {
    const Lanes3 from_a = Minus(p, a);
    const EdgeView first = View(from_a, Minus(b, a), normal), second = View(Minus(p, b), Minus(c, b), normal),
                   third = View(Minus(p, c), Minus(a, c), normal);
    const Lanes to_edges2 = first.distance2.min(second.distance2).min(third.distance2);
    const Lanes inside = first.side.min(second.side).min(third.side);
    const Lanes height = Dot(normal, from_a);
    return (inside > 0.0f).select(height * height, to_edges2);
  }
};

/// Boxes of four subtrees. What is not there is infinitely far away.
struct Node {
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::min();
  Lanes3 low, high;
  std::array<std::int32_t, kWidth> child{kNone, kNone, kNone, kNone};  // a node; or the complement of a leaf

  void SetBox(int lane, const Eigen::AlignedBox3f& box) {
    const Eigen::Vector3f nowhere = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
    low.Set(lane, box.isEmpty() ? nowhere : box.min());
    high.Set(lane, box.isEmpty() ? nowhere : box.max());
  }

  [[gnu::always_inline]] [[nodiscard]] Lanes SquaredDistances(const Lanes3& p) const {
    const Lanes3 d{(low.x - p.x).max(p.x - high.x).max(0.0f), (low.y - p.y).max(p.y - high.y).max(0.0f),
                   (low.z - p.z).max(p.z - high.z).max(0.0f)};
    return Dot(d, d);
  }
};

}  // namespace

struct MeshBvh::Impl {
  std::vector<std::array<Vector3, 3>> corners;  ///< of each triangle, in metres
  std::vector<Node> nodes;                      ///< the first is the root
  std::vector<Leaf> leaves;
  Vector3 middle_m{Vector3::Zero()};
  double reach_m{0.0};  ///< of the mesh from its middle

  [[nodiscard]] TriangleHit HitOf(const Vector3& p_m, std::uint32_t t) const {
    const Feature nearest = NearestOnTriangle(p_m, corners[t][0], corners[t][1], corners[t][2]);
    return {
        .p_m = nearest.p, .distance_m = (p_m - nearest.p).norm(), .triangle = t, .feature = nearest.feature};
  }

  /// Where a subtree's place and box go: the node above and the lane in it.
  struct Slot {
    std::size_t node;
    int lane;
  };
  Eigen::AlignedBox3f Build(std::span<std::uint32_t> triangles, const Slot& slot);
  [[nodiscard]] Eigen::AlignedBox3f MakeLeaf(std::span<const std::uint32_t> triangles, const Slot& slot);
  [[nodiscard]] std::size_t Split(std::span<std::uint32_t> triangles) const;
};

/// Parts triangles at the median of their centres along the axis in which these spread most. @returns the
/// size of the first part, a multiple of a leaf's.
std::size_t MeshBvh::Impl::Split(std::span<std::uint32_t> triangles) const {
  const auto center = [this](std::uint32_t t) -> Vector3 {
    return corners[t][0] + corners[t][1] + corners[t][2];
  };
  Eigen::AlignedBox3d box;
  for (const std::uint32_t t : triangles) box.extend(center(t));
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t half = (triangles.size() / 2 + kWidth - 1) / kWidth * kWidth;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half), triangles.end(),
                   [&](std::uint32_t i, std::uint32_t j) {
                     const double x = center(i)[axis], y = center(j)[axis];
                     return x < y || (x == y && i < j);
                   });
  return half;
}

Eigen::AlignedBox3f MeshBvh::Impl::MakeLeaf(std::span<const std::uint32_t> triangles, const Slot& slot) {
  nodes[slot.node].child[slot.lane] = ~static_cast<std::int32_t>(leaves.size());
  Leaf& leaf = leaves.emplace_back();
  Eigen::AlignedBox3f box;
  for (int i = 0; i < kWidth; ++i) {
    const std::uint32_t t = triangles[std::min<std::size_t>(i, triangles.size() - 1)];
    leaf.triangle[i] = t;
    std::array<Eigen::Vector3f, 3> p;
    for (int k = 0; k < 3; ++k) {
      p[k] = ((corners[t][k] - middle_m) * kMm).cast<float>();
      box.extend(p[k]);
    }
    leaf.a.Set(i, p[0]);
    leaf.b.Set(i, p[1]);
    leaf.c.Set(i, p[2]);
    const Vector3 normal = (corners[t][1] - corners[t][0]).cross(corners[t][2] - corners[t][0]);
    leaf.normal.Set(i, normal.stableNormalized().cast<float>());
  }
  return box;
}

Eigen::AlignedBox3f MeshBvh::Impl::Build(std::span<std::uint32_t> triangles, const Slot& slot) {
  if (triangles.size() <= kWidth) return MakeLeaf(triangles, slot);
  const std::size_t place = nodes.size();
  nodes[slot.node].child[slot.lane] = static_cast<std::int32_t>(place);
  nodes.emplace_back();
  std::vector<std::span<std::uint32_t>> parts{triangles};
  for (int level = 0; level < 2; ++level) {
    std::vector<std::span<std::uint32_t>> finer;
    for (const auto part : parts) {
      const std::size_t first = part.size() > kWidth ? Split(part) : part.size();
      finer.push_back(part.first(first));
      if (first < part.size()) finer.push_back(part.subspan(first));
    }
    parts = std::move(finer);
  }
  Eigen::AlignedBox3f box;
  for (int lane = 0; lane < kWidth; ++lane) {
    Eigen::AlignedBox3f part;
    if (lane < static_cast<int>(parts.size())) part = Build(parts[lane], {.node = place, .lane = lane});
    nodes[place].SetBox(lane, part);
    box.extend(part);
  }
  return box;
}

MeshBvh::MeshBvh(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  Eigen::AlignedBox3d box;
  for (const auto& [a, b, c] : mesh.triangles) {
    impl_->corners.push_back({mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]});
    for (const Vector3& v : impl_->corners.back()) box.extend(v);
  }
  impl_->middle_m = box.center();
  impl_->reach_m = 0.5 * box.sizes().maxCoeff();
  std::vector<std::uint32_t> triangles(mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  // a root above the first split: small meshes are leaves of it
  impl_->nodes.emplace_back();
  const Eigen::AlignedBox3f all = impl_->Build(triangles, {.node = 0, .lane = 0});
  impl_->nodes[0].SetBox(0, all);
  for (int lane = 1; lane < kWidth; ++lane) impl_->nodes[0].SetBox(lane, {});
}

MeshBvh::~MeshBvh() = default;

TriangleHit MeshBvh::Nearest(const Vector3& p_m) const {
  const Impl& impl = *impl_;
  const Vector3 local_m = p_m - impl.middle_m;
  const Eigen::Vector3f local_mm = (local_m * kMm).cast<float>();
  const Lanes3 p{Lanes::Constant(local_mm.x()), Lanes::Constant(local_mm.y()), Lanes::Constant(local_mm.z())};
  // what float arithmetic may be off, with room: by the size of the coordinates
  const double slack_m =
      64.0 * std::numeric_limits<float>::epsilon() * (impl.reach_m + local_m.cwiseAbs().maxCoeff());
  const auto two_slacks_mm = static_cast<float>(2.0 * slack_m * kMm);
  // what may be the nearest, by floats: those within twice the slack of the least so far
  struct Candidate {
    float distance2;
    std::uint32_t triangle;
  };
  std::array<Candidate, kMostCandidates> candidates;
  std::size_t candidate_count = 0;
  float limit2 = std::numeric_limits<float>::infinity(), least2 = limit2;  // [mm^2]
  TriangleHit hit;
  hit.distance_m = std::numeric_limits<double>::infinity();
  const auto decide = [&] {
    for (std::size_t i = 0; i < candidate_count; ++i) {
      if (candidates[i].distance2 > limit2) continue;
      const TriangleHit found = impl.HitOf(p_m, candidates[i].triangle);
      // of equally near ones the first: the answer does not depend on the order of visits
      if (found.distance_m < hit.distance_m ||
          (found.distance_m == hit.distance_m && found.triangle < hit.triangle))
        hit = found;
    }
    candidate_count = 0;
  };
  const auto propose = [&](float distance2, std::uint32_t triangle) {
    if (distance2 < least2) {
      least2 = distance2;
      const float limit = (std::sqrt(distance2) + two_slacks_mm) * (1.0f + 1e-5f);
      limit2 = limit * limit;
    }
    if (candidate_count == kMostCandidates) decide();
    candidates[candidate_count++] = {.distance2 = distance2, .triangle = triangle};
  };

  struct Task {
    float distance2;
    std::int32_t child;
  };
  // A tree over 2^32 triangles is at most 16 levels deep, each leaves 3 tasks behind; 4 on the last.
  std::array<Task, 64> tasks;
  std::size_t count = 0;
  tasks[count++] = {.distance2 = 0.0f, .child = 0};
  while (count > 0) {
    const Task task = tasks[--count];
    if (task.distance2 > limit2) continue;
    if (task.child < 0) {
      const Leaf& leaf = impl.leaves[~task.child];
      const Lanes distance2 = leaf.SquaredDistances(p);
      if (!(distance2.minCoeff() <= limit2)) continue;
      for (int i = 0; i < kWidth; ++i)
        if (distance2[i] <= limit2) propose(distance2[i], leaf.triangle[i]);
      continue;
    }
    const Node& node = impl.nodes[task.child];
    const Lanes distance2 = node.SquaredDistances(p);
    // the nearest on top
    const std::size_t first = count;
    for (int i = 0; i < kWidth; ++i) {
      if (!(distance2[i] <= limit2) || node.child[i] == Node::kNone) continue;
      std::size_t at = count++;
      for (; at > first && tasks[at - 1].distance2 < distance2[i]; --at) tasks[at] = tasks[at - 1];
      tasks[at] = {.distance2 = distance2[i], .child = node.child[i]};
    }
  }
  decide();
  return hit;
}

}  // namespace osteon::simulation
