#include "simulation/mesh/triangle_tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace osteon::simulation {
namespace {

constexpr std::int32_t kNoChild = std::numeric_limits<std::int32_t>::max();
constexpr std::uint32_t kOfLeaf = 4;  // largest number of triangles in a leaf
// Relative rounding error of a float.
constexpr double kFloat = std::numeric_limits<float>::epsilon();

/// Nearest point of a triangle, and the feature on which it lies.
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
  if (!(sum > 0.0))
    return {a, TriangleFeature::kCorner0};  // no area: a neighbour with a common edge is as near
  return {a + vb / sum * ab + vc / sum * ac, TriangleFeature::kFace};
}

// Result of the last search that a thread made in a tree.
struct Found {
  std::uint64_t tree{0};
  std::uint32_t triangle{0};  ///< in the tree's order
  Vector3 p_m{Vector3::Zero()};
  TriangleHit hit;
};

/// A number that no earlier call has returned.
std::uint64_t NewId() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace

TriangleTree::TriangleTree(const TriangleMesh& mesh) : id_(NewId()) {
  Eigen::AlignedBox3d box;
  triangles_.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle& triangle = triangles_.emplace_back();
    triangle.index = i;
    for (int k = 0; k < 3; ++k) {
      triangle.corners_m[k] = mesh.vertices_m[mesh.triangles[i][k]];
      box.extend(triangle.corners_m[k]);
    }
  }
  middle_m_ = box.center();
  extent_m_ = 0.5 * box.sizes().maxCoeff();
  nodes_.reserve(triangles_.size() / 2 + 1);
  Divide(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t TriangleTree::Halve(std::uint32_t first, std::uint32_t end) {
  const auto sum = [](const Triangle& t) -> Vector3 {
    return t.corners_m[0] + t.corners_m[1] + t.corners_m[2];
  };
  Eigen::AlignedBox3d sums;
  for (std::uint32_t i = first; i < end; ++i) sums.extend(sum(triangles_[i]));
  int axis = 0;
  sums.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + end,
                   [&](const Triangle& a, const Triangle& b) { return sum(a)[axis] < sum(b)[axis]; });
  return middle;
}

std::int32_t TriangleTree::MakeLeaf(std::uint32_t first, std::uint32_t end) {
  Leaf& leaf = leaves_.emplace_back();
  leaf.first = first;
  leaf.count = end - first;
  for (std::uint32_t k = 0; k < leaf.count; ++k) {
    const auto& [a, b, c] = triangles_[first + k].corners_m;
    const auto radius_around = [&](const Vector3& p) {
      return std::sqrt(std::max({(a - p).squaredNorm(), (b - p).squaredNorm(), (c - p).squaredNorm()}));
    };
    // for an obtuse triangle, the middle of the longest edge gives a smaller disc than the centroid
    Vector3 center = (a + b + c) / 3.0;
    for (const Vector3& middle : {Vector3(0.5 * (a + b)), Vector3(0.5 * (b + c)), Vector3(0.5 * (c + a))})
      if (radius_around(middle) < radius_around(center)) center = middle;
    const Vector3 ab = b - a, ac = c - a, cross = ab.cross(ac);
    constexpr double kNeedle = 1e-3;  // sine of the angle below which a triangle has no reliable normal
    const bool needle = !(cross.norm() > kNeedle * ab.norm() * ac.norm());
    const Vector3 normal = needle ? Vector3(Vector3::Zero()) : Vector3(cross.normalized());
    for (int axis = 0; axis < 3; ++axis) {
      leaf.center[axis][k] = static_cast<float>(center[axis] - middle_m_[axis]);
      leaf.normal[axis][k] = static_cast<float>(normal[axis]);
    }
    leaf.radius[k] = static_cast<float>(radius_around(center) * (1.0 + 4.0 * kFloat));
  }
  return static_cast<std::int32_t>(leaves_.size()) - 1;
}

std::int32_t TriangleTree::Divide(std::uint32_t first, std::uint32_t end) {
  const auto index = static_cast<std::int32_t>(nodes_.size());
  nodes_.emplace_back();
  std::array<std::uint32_t, 5> at{};  // child k has the triangles from at[k] to at[k + 1]
  if (end - first <= kOfLeaf) {
    at = {first, end, end, end, end};
  } else {
    const std::uint32_t middle = Halve(first, end);
    at = {first, Halve(first, middle), middle, Halve(middle, end), end};
  }
  for (int k = 0; k < 4; ++k) {
    Eigen::AlignedBox3d box;
    for (std::uint32_t i = at[k]; i < at[k + 1]; ++i)
      for (const Vector3& corner : triangles_[i].corners_m) box.extend(corner - middle_m_);
    const std::uint32_t count = at[k + 1] - at[k];
    const std::int32_t child = count == 0         ? kNoChild
                               : count <= kOfLeaf ? ~MakeLeaf(at[k], at[k + 1])
                                                  : Divide(at[k], at[k + 1]);
    Node& node = nodes_[index];  // not before: Divide may move the nodes
    node.child[k] = child;
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][k] =
          count == 0 ? kInfinity : std::nextafter(static_cast<float>(box.min()[axis]), -kInfinity);
      node.high[axis][k] =
          count == 0 ? -kInfinity : std::nextafter(static_cast<float>(box.max()[axis]), kInfinity);
    }
  }
  return index;
}

/// A search for the point of the surface nearest to p_m.
struct TriangleTree::Search {
  using Pack = Eigen::Array4f;

  const TriangleTree& tree;
  Vector3 p_m;
  Eigen::Vector3f q_m;  ///< p_m relative to middle_m_
  double slack_m;       ///< bound, with a margin, on the errors of boxes and point by rounding to float
  TriangleHit hit;
  std::uint32_t triangle{0};  ///< index of the hit in triangles_
  float limit_m2{0.0f};       ///< squared distance within which a box may hold a nearer triangle

  /// Makes triangle i of triangles_ the hit if it is nearer than the hit so far. Of equally near triangles,
  /// the first in the mesh counts.
  void Take(std::uint32_t i) {
    const Triangle& t = tree.triangles_[i];
    const Feature nearest = NearestOnTriangle(p_m, t.corners_m[0], t.corners_m[1], t.corners_m[2]);
    const double distance = (p_m - nearest.p).norm();
    if (!(distance < hit.distance_m || (distance == hit.distance_m && t.index < hit.triangle))) return;
    hit = {.p_m = nearest.p, .distance_m = distance, .triangle = t.index, .feature = nearest.feature};
    triangle = i;
    Limit();
  }
  /// Updates limit_m2 after a hit.
  void Limit() {
    const double reach_m = (hit.distance_m + slack_m) * (1.0 + 1e-6);
    limit_m2 = static_cast<float>(reach_m * reach_m);
  }
  [[nodiscard]] static Pack Of(const Four& four) {
    return Eigen::Map<const Pack, Eigen::Aligned16>(four.data());
  }

  /// Squared distances to a node's boxes.
  void Measure(const Node& node, Four& distances_m2) const {
    Pack sum = Pack::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Pack off = (Of(node.low[axis]) - q_m[axis]).max(q_m[axis] - Of(node.high[axis])).max(0.0f);
      sum += off * off;
    }
    Eigen::Map<Pack, Eigen::Aligned16>(distances_m2.data()) = sum;
  }
  /// Lower bounds of the squared distances to a leaf's discs: the squared distance from the disc's plane plus
  /// the squared distance from its rim within the plane.
  void Measure(const Leaf& leaf, Four& distances_m2) const {
    Pack along = Pack::Zero(), squared = Pack::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Pack to = q_m[axis] - Of(leaf.center[axis]);
      along += to * Of(leaf.normal[axis]);
      squared += to * to;
    }
    along *= along;
    const Pack beside = ((squared - along).max(0.0f).sqrt() - Of(leaf.radius)).max(0.0f);
    constexpr float kRounding = 4e-6f;  // several times the rounding error of the sums and of the normal
    Eigen::Map<Pack, Eigen::Aligned16>(distances_m2.data()) = along + beside * beside - kRounding * squared;
  }

  /// Tests the triangles of a leaf whose discs are within the limit.
  void Try(const Leaf& leaf) {
    alignas(16) Four bounds_m2;
    Measure(leaf, bounds_m2);
    for (std::uint32_t k = 0; k < leaf.count; ++k)
      if (bounds_m2[k] <= limit_m2) Take(leaf.first + k);
  }

  /// Searches the tree from the root: depth first, nearer children first.
  void Descend() {
    struct Open {
      float distance_m2;
      std::int32_t node;
    };
    // 64 entries suffice: each level of the tree adds at most three open nodes, and a node has only a quarter
    // of its parent's triangles.
    std::array<Open, 64> open;
    int count = 1;
    open[0] = {0.0f, 0};
    while (count > 0) {
      const Open next = open[--count];
      if (!(next.distance_m2 <= limit_m2)) continue;
      if (next.node < 0) {
        Try(tree.leaves_[~next.node]);
        continue;
      }
      const Node& node = tree.nodes_[next.node];
      alignas(16) Four distances_m2;
      Measure(node, distances_m2);
      const int first = count;
      for (int k = 0; k < 4; ++k) {
        const float distance_m2 = distances_m2[k];
        if (!(distance_m2 <= limit_m2) || node.child[k] == kNoChild) continue;
        int at = count++;
        for (; at > first && open[at - 1].distance_m2 < distance_m2; --at) open[at] = open[at - 1];
        open[at] = {distance_m2, node.child[k]};
      }
    }
  }
};

TriangleHit TriangleTree::Nearest(const Vector3& p_m) const {
  // Remembers one search for each of a few trees, because a solid queries its boundary and its regions in
  // turn.
  constexpr std::size_t kTrees = 8;
  thread_local std::array<Found, kTrees> found;
  Found& last = found[id_ % kTrees];
  const bool again = last.tree == id_;
  if (again && last.p_m == p_m) return last.hit;
  Search search{.tree = *this,
                .p_m = p_m,
                .q_m = (p_m - middle_m_).cast<float>(),
                .slack_m = 8.0 * kFloat * (extent_m_ + (p_m - middle_m_).cwiseAbs().maxCoeff()),
                .hit = {}};
  search.hit.distance_m = std::numeric_limits<double>::infinity();
  search.Limit();
  // Start with the triangle found last: most points are near the point before, so this bounds the search
  // well. The result does not depend on the triangle with which the search starts.
  if (again) search.Take(last.triangle);
  search.Descend();
  last = {.tree = id_, .triangle = search.triangle, .p_m = p_m, .hit = search.hit};
  return search.hit;
}

}  // namespace osteon::simulation
