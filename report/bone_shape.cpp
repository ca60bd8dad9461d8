#include "report/bone_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/percentile.h"
#include "simulation/bone/material_style.h"
#include "simulation/removal/cut_metrics.h"

namespace osteon::report {
namespace {

using simulation::Ball;
using simulation::Bone;
using simulation::MassPoint;
using simulation::MaterialIndex;

/// The balls' bounding boxes, in their order.
std::vector<CellGrid::Item> Boxes(std::span<const Ball> balls) {
  std::vector<CellGrid::Item> items;
  for (const Ball& ball : balls) {
    const Vector3 c = ball.center_m, r = Vector3::Constant(ball.radius_m);
    items.push_back({c - r, c + r});
  }
  return items;
}

/// A box without extent at each point, in their order.
std::vector<CellGrid::Item> Boxes(std::span<const MassPoint> points) {
  std::vector<CellGrid::Item> items;
  for (const MassPoint& point : points) items.push_back({point.p_m, point.p_m});
  return items;
}

/// Mean radius of the balls [m]; 1 mm if there are no balls.
double MeanRadius(std::span<const Ball> balls) {
  double sum = 0.0;
  for (const Ball& ball : balls) sum += ball.radius_m;
  return balls.empty() ? 1e-3 : sum / static_cast<double>(balls.size());
}

/// Edge of a cube with the median of the points' volumes [m]; 1 mm if there are no points.
double MedianSpacing(std::span<const MassPoint> points) {
  if (points.empty()) return 1e-3;
  std::vector<double> volumes;
  for (const MassPoint& point : points) volumes.push_back(point.volume_m3);
  return std::cbrt(std::max(base::Median(volumes), 1e-15));
}

bool Finite(const Vector3& v) { return v.allFinite(); }

}  // namespace

BallField::BallField(std::vector<Ball> balls) : balls_(std::move(balls)) {
  std::erase_if(balls_, [](const Ball& ball) {
    return !Finite(ball.center_m) || !(ball.radius_m > 0.0) || !std::isfinite(ball.radius_m);
  });
  const auto items = Boxes(balls_);
  grid_ = CellGrid(items, 2.0 * MeanRadius(balls_));
}

double BallField::Depth(const Vector3& p_G) const {
  double depth_m = -std::numeric_limits<double>::infinity();
  const CellGrid::Index cell = grid_.At(p_G);
  if (!grid_.Contains(cell)) return depth_m;
  for (const std::uint32_t i : grid_[cell]) {
    const double inside_m = balls_[i].radius_m - (p_G - Vector3(balls_[i].center_m)).norm();
    if (inside_m >= 0.0) depth_m = std::max(depth_m, inside_m);
  }
  return depth_m;
}

// Visits the grid's cells along the ray one after the other. Source: Amanatides and Woo, A Fast Voxel
// Traversal Algorithm for Ray Tracing, Eurographics 1987.
std::optional<double> BallField::FirstHit(const Vector3& o_G, const Vector3& d_G, double max_m) const {
  if (balls_.empty()) return std::nullopt;
  // the part of the ray inside the grid's box
  double from = 0.0, to = max_m;
  for (int k = 0; k < 3; ++k) {
    const double low = grid_.min()[k], high = low + grid_.cell_m() * grid_.size()[k];
    if (std::abs(d_G[k]) < 1e-12) {
      if (o_G[k] < low || o_G[k] > high) return std::nullopt;
      continue;
    }
    const double a = (low - o_G[k]) / d_G[k], b = (high - o_G[k]) / d_G[k];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  if (!(from <= to)) return std::nullopt;

  // for each axis: next is the distance along the ray to the next cell wall, step the distance between two
  // walls
  CellGrid::Index cell = grid_.Clamped(o_G + from * d_G);
  std::array<double, 3> next{}, step{};
  for (int k = 0; k < 3; ++k) {
    const bool up = d_G[k] > 0.0;
    const double wall = grid_.min()[k] + grid_.cell_m() * (cell[k] + (up ? 1 : 0));
    const bool flat = std::abs(d_G[k]) < 1e-12;
    next[k] = flat ? std::numeric_limits<double>::infinity() : (wall - o_G[k]) / d_G[k];
    step[k] = flat ? std::numeric_limits<double>::infinity() : grid_.cell_m() / std::abs(d_G[k]);
  }
  double first_m = std::numeric_limits<double>::infinity();
  while (grid_.Contains(cell)) {
    for (const std::uint32_t i : grid_[cell]) {
      const Vector3 c = Vector3(balls_[i].center_m) - o_G;
      // the ray enters the ball at the smaller root s of |o + s d - c|² = r²
      const double r2 = balls_[i].radius_m * balls_[i].radius_m, middle = c.dot(d_G);
      const double discriminant = middle * middle - c.squaredNorm() + r2;
      if (c.squaredNorm() <= r2) return 0.0;
      if (discriminant < 0.0 || middle < 0.0) continue;
      first_m = std::min(first_m, middle - std::sqrt(discriminant));
    }
    const int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
    if (first_m <= next[k] || next[k] > to) break;
    cell[k] += d_G[k] > 0.0 ? 1 : -1;
    next[k] += step[k];
  }
  if (first_m <= max_m) return first_m;
  return std::nullopt;
}

std::vector<Ball> CarvedBalls(const Bone& bone, const simulation::CarvedState& state) {
  if (state.balls.empty()) return bone.balls;
  if (state.balls.size() != 4 * bone.balls.size()) return {};
  return simulation::LiveBalls(state);
}

double SiteReach(const Bone& bone, double radii) {
  // for radii = kAtRadii the distance is at least kAround_m, unless the bone ends before
  constexpr double kAround_m = 25e-3, kAtRadii = 3.2;
  const Vector3 center = bone.site.center_m;
  double farthest_m = 0.0;
  for (const Ball& ball : bone.balls)
    if (const Vector3 c = ball.center_m; c.allFinite())
      farthest_m = std::max(farthest_m, (c - center).norm() + ball.radius_m);
  return std::max(radii * std::max(bone.site.radius_m, 1e-3),
                  std::min(farthest_m, kAround_m * radii / kAtRadii));
}

MaterialMap::MaterialMap(std::span<const MassPoint> points, const simulation::Solid* solid) : solid_(solid) {
  if (solid_) return;
  for (const MassPoint& point : points)
    if (Finite(point.p_m)) points_.push_back(point);
  const auto items = Boxes(points_);
  grid_ = CellGrid(items, 1.5 * MedianSpacing(points_));
}

std::optional<MaterialIndex> MaterialMap::At(const Vector3& p_G) const {
  if (solid_) return solid_->MaterialAt(p_G);
  if (grid_.empty()) return std::nullopt;
  constexpr int kReach = 8;  // rings of cells around p that are searched
  const CellGrid::Index at = grid_.At(p_G);
  double best_m2 = std::numeric_limits<double>::infinity();  // squared distance
  MaterialIndex material = 0;
  for (int ring = 0; ring <= kReach; ++ring) {
    // items in this ring and in farther ones are at least this far away
    const double ring_m = (ring - 1) * grid_.cell_m();
    if (ring_m > 0.0 && best_m2 <= ring_m * ring_m) break;
    for (int z = at[2] - ring; z <= at[2] + ring; ++z)
      for (int y = at[1] - ring; y <= at[1] + ring; ++y) {
        const bool face = std::abs(z - at[2]) == ring || std::abs(y - at[1]) == ring;
        // only the ring's outer cells, since the inner ones were searched before
        for (int x = at[0] - ring; x <= at[0] + ring; x += face || ring == 0 ? 1 : 2 * ring) {
          if (!grid_.Contains({x, y, z})) continue;
          for (const std::uint32_t i : grid_[{x, y, z}]) {
            const double distance2 = (Vector3(points_[i].p_m) - p_G).squaredNorm();
            if (distance2 < best_m2) {
              best_m2 = distance2;
              material = points_[i].material;
            }
          }
        }
      }
  }
  if (!std::isfinite(best_m2)) return std::nullopt;
  return material;
}

const char* MaterialTint(const Bone& bone, MaterialIndex material) {
  return simulation::StyleOf(bone.materials, material).tint;
}

Vector3 MaterialColor(const Bone& bone, MaterialIndex material) {
  const auto& color = simulation::StyleOf(bone.materials, material).color;
  return {color[0], color[1], color[2]};
}

}  // namespace osteon::report
