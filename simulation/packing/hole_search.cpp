#include "simulation/packing/hole_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/scramble.h"

namespace osteon::simulation {
namespace {

/// Point i of `count` of Fibonacci's lattice on the sphere.
Vector3 SpherePoint(int i, int count) {
  const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
  const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

/// Uniformly distributed rotation. Source: Shoemake, Graphics Gems III, 1992.
Matrix3 RandomRotation(std::uint64_t bits) {
  const double a = Uniform(bits = Scramble(bits)),
               b = Uniform(bits = Scramble(bits)) * 2.0 * std::numbers::pi;
  const double c = Uniform(Scramble(bits)) * 2.0 * std::numbers::pi;
  const double s = std::sqrt(1.0 - a), t = std::sqrt(a);
  return Eigen::Quaterniond(t * std::cos(c), s * std::sin(b), s * std::cos(b), t * std::sin(c))
      .toRotationMatrix();
}

constexpr int kNeighbors = 6;

/// Directions spread evenly over the sphere, and the six nearest neighbours of each.
template <int kCount>
struct Lattice {
  std::array<Vector3, kCount> points;
  std::array<std::array<int, kNeighbors>, kCount> neighbors;

  Lattice() {
    for (int i = 0; i < kCount; ++i) points[i] = SpherePoint(i, kCount);
    for (int i = 0; i < kCount; ++i) {
      std::array<std::pair<double, int>, kCount> by_angle;
      for (int j = 0; j < kCount; ++j) by_angle[j] = {-points[i].dot(points[j]), j};
      std::sort(by_angle.begin(), by_angle.end());
      for (int k = 0; k < kNeighbors; ++k)
        neighbors[i][k] = by_angle[k + 1].second;  // by_angle[0] is the direction itself
    }
  }
};

}  // namespace

void HoleSearch::AroundBall(std::size_t index, double min_m, double max_m, std::vector<Ball>& found) {
  static const Lattice<kDirections> lattice;
  const Ball ball = balls_.balls()[index];
  const Vector3 center = ball.center_m;
  const double r = ball.radius_m;
  const Matrix3 turn = RandomRotation(seed_ ^ Scramble(index));
  for (int j = 0; j < kDirections; ++j) {
    const Vector3 u = turn * lattice.points[j];
    x_[j] = u.x();
    y_[j] = u.y();
    z_[j] = u.z();
  }
  radius_m_.fill(max_m);
  climb_.CacheNeighbours(center, r + 2.0 * max_m);
  for (const Ball& other : climb_.cached())
    if ((center - Vector3(other.center_m)).squaredNorm() > r * r)
      BoundByBall(ball, other);  // skip the ball itself
  if (depths_.LowerBound(center) < r + 2.0 * max_m) BoundBySurface(ball, max_m);
  const bool capped = BoundByCap(ball, max_m);

  const std::size_t first = found.size();
  const auto climb_from = [&](int j) {
    const Vector3 p = center + (r + radius_m_[j]) * Vector3(x_[j], y_[j], z_[j]);
    AppendHole(climb_.Climb(p, radius_m_[j], min_m), min_m, first, found);
  };
  bool all_capped = true;
  for (int j = 0; j < kDirections; ++j) {
    all_capped &= capped_[j] != 0.0;
    if (radius_m_[j] < 0.6 * min_m)
      continue;  // 0.6, because the directions are coarse, and a climb from there still reaches a larger
                 // radius
    bool is_maximum = true, at_rim = false;
    for (const int k : lattice.neighbors[j]) {
      is_maximum &= radius_m_[k] < radius_m_[j] || (radius_m_[k] == radius_m_[j] && k > j);
      at_rim |= capped_[k] == 0.0;
    }
    // If the cap limits the radius in this direction, start only at the rim of the directions that it limits:
    // there a ball of the cap's radius also touches another obstacle.
    if (capped && capped_[j] != 0.0 ? at_rim : is_maximum) climb_from(j);
  }
  if (all_capped) climb_from(0);
}

/// Bounds the radii by the surface. The surface is probed at a dozen points around the ball.
void HoleSearch::BoundBySurface(const Ball& ball, double max_m) {
  constexpr int kProbes = 12;
  static const Lattice<kProbes> lattice;
  const Vector3 center = ball.center_m;
  const double r = ball.radius_m, probe_distance = r + 0.5 * std::min(r, max_m);
  std::array<Vector3, kProbes> normals;
  int count = 0;
  for (const Vector3& u : lattice.points) {
    const Vector3 p = center + probe_distance * u;
    const SurfacePoint surface = solid_.NearestSurface(p);
    if (std::abs(surface.distance_m) < 1e-9) continue;  // too near to determine the normal
    const Vector3 n = (p - surface.p_m) / -surface.distance_m;
    if (std::any_of(normals.begin(), normals.begin() + count,
                    [&n](const Vector3& m) { return m.dot(n) > 0.98; }))
      continue;
    normals[count++] = n;
    // Approximate the surface by a ball on its other side: a plane would exclude the holes beside a surface
    // that bulges inwards.
    BoundByBall(ball, {.center_m = surface.p_m - 2.0 * r * n, .radius_m = 2.0 * r});
  }
}

/// Solves |c + (r + s) u - c'| = r' + s for the radius s of a ball that touches `ball` (c, r) in the
/// direction u, and also `other` (c', r').
void HoleSearch::BoundByBall(const Ball& ball, const Ball& other) {
  const Vector3 d = Vector3(ball.center_m) - Vector3(other.center_m);
  const double dx = d.x(), dy = d.y(), dz = d.z(), r = ball.radius_m;
  const double constant = d.squaredNorm() + r * r - other.radius_m * other.radius_m;
  const double difference = other.radius_m - r;
  for (int j = 0; j < kDirections; ++j) {
    const double along = x_[j] * dx + y_[j] * dy + z_[j] * dz;
    const double s = (constant + 2.0 * r * along) / (2.0 * (difference - along));
    radius_m_[j] = difference > along && s < radius_m_[j] ? s : radius_m_[j];
  }
}

bool HoleSearch::BoundByCap(const Ball& ball, double max_m) {
  capped_.fill(0.0);
  const Vector3 center = ball.center_m;
  const double cap = cap_.At(center), r = ball.radius_m;
  if (cap - cap_.grade * (r + max_m) > max_m) return false;
  // gradient of the cap; the depth below the zone is not smooth everywhere, but a start of a climb need not
  // be exact
  Vector3 slope = Vector3::Zero();
  if (cap_.grade > 0.0)
    for (int axis = 0; axis < 3; ++axis)
      slope[axis] = (cap_.At(center + 0.1 * r * Vector3::Unit(axis)) - cap) / (0.1 * r);
  bool any = false;
  for (int j = 0; j < kDirections; ++j) {
    const double along = slope.x() * x_[j] + slope.y() * y_[j] + slope.z() * z_[j];
    const double s = along < 1.0 ? std::max(cap_.radius_m, (cap + r * along) / (1.0 - along)) : max_m;
    if (s > radius_m_[j]) continue;
    radius_m_[j] = s;
    capped_[j] = 1.0;
    any = true;
  }
  return any;
}

/// Appends the hole to `found`, unless it is smaller than min_m or already among found[first …].
void HoleSearch::AppendHole(const Ball& hole, double min_m, std::size_t first,
                            std::vector<Ball>& found) const {
  if (!(hole.radius_m >= min_m)) return;
  for (std::size_t i = first; i < found.size(); ++i)
    if ((Vector3(hole.center_m) - Vector3(found[i].center_m)).squaredNorm() <
        1e-4 * hole.radius_m * hole.radius_m)
      return;
  found.push_back(hole);
}

Ball HoleSearch::From(const Vector3& p_m, double scale_m, double min_m) {
  climb_.CacheNeighbours(p_m, 3.0 * scale_m);
  return climb_.Climb(p_m, scale_m, min_m);
}

struct HoleSearch::CubeSearch {
  double min_m;
  std::size_t first;  ///< index in `found` of the first hole of this search
  std::vector<Ball>& found;
  std::vector<Ball> near;  ///< a stack: the relevant balls of the cube, then those of its eighth, …
};

void HoleSearch::InCube(const Vector3& center_m, double side_m, double min_m, std::vector<Ball>& found) {
  CubeSearch search{.min_m = min_m, .first = found.size(), .found = found, .near = {}};
  balls_.Gather(center_m, kSure * min_m + std::sqrt(0.75) * side_m, search.near);
  Divide(search, center_m, side_m, depths_.LowerBound(center_m), 0, search.near.size(), false);
}

/// @param depth_m  a lower bound of the centre's depth in the solid
/// @param first, last  range of the relevant balls in search.near
/// @param climbed  true if a climb already started in a cube around this one, although a hole was not certain
void HoleSearch::Divide(CubeSearch& search, const Vector3& center_m, double side_m, double depth_m,
                        std::size_t first, std::size_t last, bool climbed) {
  // The clearance anywhere in the cube is at most that of its centre plus half the diagonal.
  const double reach = std::sqrt(0.75) * side_m, sure = kSure * search.min_m;
  double clearance = sure + reach;
  // updates the clearance with a ball, and keeps the ball for the cube's eighths if it is near enough
  const auto consider = [&](const Ball& ball) {
    const double gap = (center_m - Vector3(ball.center_m)).norm() - ball.radius_m;
    if (gap < sure + reach) search.near.push_back(ball);
    clearance = std::min(clearance, gap);
  };
  for (std::size_t i = first; i < last; ++i) {
    const Ball ball = search.near[i];  // a copy, because search.near grows
    consider(ball);
  }
  for (std::size_t i = search.first; i < search.found.size(); ++i) consider(search.found[i]);
  depth_m = std::max(depth_m, depths_.LowerBound(center_m));
  if (clearance + reach >= sure && depth_m < clearance) {
    depth_m = -solid_.SignedDistance(center_m);
    clearance = std::min(clearance, depth_m);
  }
  if (clearance + reach >= sure) {
    const bool sure_hole = clearance >= search.min_m;
    if (sure_hole || (!climbed && clearance >= 0.8 * search.min_m)) {
      climbed = true;
      const std::size_t before = search.found.size();
      AppendHole(From(center_m, search.min_m, search.min_m), search.min_m, search.first, search.found);
      // if the climb only found a known hole, the cube's centre has room for another ball, which is added
      if (sure_hole && search.found.size() == before)
        search.found.push_back({.center_m = center_m, .radius_m = std::min(clearance, cap_.At(center_m))});
    }
    // Do not divide a cube with a certain hole: the cube is searched again after the hole is filled.
    if (!sure_hole) {
      const std::size_t end = search.near.size();
      for (int i = 0; i < 8; ++i) {
        const Vector3 offset = 0.25 * side_m * Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        Divide(search, center_m + offset, 0.5 * side_m, depth_m - 0.5 * reach, last, end, climbed);
      }
    }
  }
  search.near.resize(last);
}

}  // namespace osteon::simulation
