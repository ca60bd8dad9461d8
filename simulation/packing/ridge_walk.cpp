#include "simulation/packing/ridge_walk.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osteon::simulation {
namespace {

/// The point of a convex hull of up to four points that is nearest to the origin, and those of the points of
/// which it is a combination.
struct Nearest {
  Vector3 point{Vector3::Zero()};
  std::array<int, 4> of{};  ///< indices of those points; `count` of them
  int count{0};
};

// The functions below find the nearest point of a segment, a triangle or a tetrahedron. They take the points
// p and the corners' indices. A degenerate triangle is replaced by its edges, a degenerate tetrahedron by its
// faces.

Nearest NearestOfSegment(const std::array<Vector3, 4>& p, int a, int b) {
  const Vector3 ab = p[b] - p[a];
  const double t = -p[a].dot(ab), length = ab.squaredNorm();
  if (t <= 0.0 || !(length > 0.0)) return {p[a], {a}, 1};
  if (t >= length) return {p[b], {b}, 1};
  return {p[a] + t / length * ab, {a, b}, 2};
}

Nearest Nearer(const Nearest& a, const Nearest& b) {
  return b.point.squaredNorm() < a.point.squaredNorm() ? b : a;
}

Nearest NearestOfTriangle(const std::array<Vector3, 4>& p, int a, int b, int c) {
  const Vector3 ab = p[b] - p[a], ac = p[c] - p[a];
  const Vector3 normal = ab.cross(ac);
  const double area = normal.squaredNorm();
  if (area > 1e-20) {
    // barycentric coordinates of the origin's projection
    const double wb = ac.cross(p[a]).dot(normal), wc = p[a].cross(ab).dot(normal);
    if (wb > 0.0 && wc > 0.0 && wb + wc < area) return {normal.dot(p[a]) / area * normal, {a, b, c}, 3};
  }
  return Nearer(Nearer(NearestOfSegment(p, a, b), NearestOfSegment(p, a, c)), NearestOfSegment(p, b, c));
}

Nearest NearestOfTetrahedron(const std::array<Vector3, 4>& p) {
  const auto volume = [](const Vector3& a, const Vector3& b, const Vector3& c) { return a.dot(b.cross(c)); };
  const double whole = volume(p[1] - p[0], p[2] - p[0], p[3] - p[0]);
  if (std::abs(whole) > 1e-12) {
    const double w0 = volume(p[1], p[2], p[3]) / whole, w1 = -volume(p[0], p[2], p[3]) / whole;
    const double w2 = volume(p[0], p[1], p[3]) / whole, w3 = -volume(p[0], p[1], p[2]) / whole;
    if (std::min(std::min(w0, w1), std::min(w2, w3)) > 0.0) return {Vector3::Zero(), {0, 1, 2, 3}, 4};
  }
  return Nearer(Nearer(NearestOfTriangle(p, 0, 1, 2), NearestOfTriangle(p, 0, 1, 3)),
                Nearer(NearestOfTriangle(p, 0, 2, 3), NearestOfTriangle(p, 1, 2, 3)));
}

Nearest NearestOfHull(const std::array<Vector3, 4>& p, int count) {
  if (count == 1) return {p[0], {0}, 1};
  if (count == 2) return NearestOfSegment(p, 0, 1);
  if (count == 3) return NearestOfTriangle(p, 0, 1, 2);
  return NearestOfTetrahedron(p);
}

}  // namespace

RidgeWalk WalkRidges(std::span<const ClearanceBound> bounds, double max_m) {
  Vector3 step = Vector3::Zero();
  std::array<std::size_t, 4> active{};
  int count = 1;
  for (std::size_t k = 1; k < bounds.size(); ++k)
    if (bounds[k].value_m < bounds[active[0]].value_m) active[0] = k;
  double t = bounds[active[0]].value_m;

  constexpr int kMaxTurns = 16;  // limit; most walks need four to six turns
  for (int turn = 0; turn < kMaxTurns; ++turn) {
    std::array<Vector3, 4> gradients;
    for (int i = 0; i < count; ++i) gradients[i] = bounds[active[i]].gradient;
    const Nearest up = NearestOfHull(gradients, count);
    const double rate = up.point.squaredNorm();
    if (!(rate > 1e-14)) break;
    // in ascending order, so that up.of[i] >= i
    for (int i = 0; i < up.count; ++i) active[i] = active[up.of[i]];
    count = up.count;

    // length of this leg: up to where another obstacle is as near as the active ones, or to |step| = max_m
    // (quadratic formula)
    const double a = rate, b = step.dot(up.point), c = step.squaredNorm() - max_m * max_m;
    double length = (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
    std::size_t next = bounds.size();
    for (std::size_t k = 0; k < bounds.size(); ++k) {
      const double closing = rate - bounds[k].gradient.dot(up.point);
      if (closing <= 1e-12) continue;
      if (std::find(active.begin(), active.begin() + count, k) != active.begin() + count) continue;
      const double gap = std::max(0.0, bounds[k].value_m + bounds[k].gradient.dot(step) - t);
      if (gap < closing * length) {
        length = gap / closing;
        next = k;
      }
    }
    step += length * up.point;
    t += length * rate;
    if (next == bounds.size()) break;
    active[count++] = next;
  }
  return {.step_m = step, .clearance_m = t};
}

}  // namespace osteon::simulation
