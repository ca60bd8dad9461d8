#include "studies/pack/packing_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace osteon::studies {
namespace {

using simulation::Ball;

constexpr int kFine = 2;  ///< samples per pixel in each direction

/// The first surface that a ray meets.
struct Hit {
  double depth_m{std::numeric_limits<double>::infinity()};
  std::size_t ball{0};
  bool in_plane{false};  ///< the surface is the cut face of the ball, in the cutting plane
};

/// A colour value 0 … 1 as a byte.
std::uint8_t ToByte(double value) {
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

/// Finds the first ball that each pixel's ray meets, after the half-space in front of the cutting plane is
/// removed.
///
/// Balls that cross the plane are drawn first, the larger before the smaller, then all others from front to
/// back. As nothing lies in front of the plane, a tile is complete when all its pixels show the plane. A ball
/// is skipped in a tile if it lies behind everything that the tile shows.
class Tracer {
 public:
  Tracer(std::span<const Ball> balls, const report::Camera& camera, const std::optional<CutAway>& cut)
      : balls_(balls),
        camera_(camera),
        cut_(cut),
        columns_((camera.width + kTile - 1) / kTile),
        tiles_(static_cast<std::size_t>(columns_) * ((camera.height + kTile - 1) / kTile)),
        hits_(static_cast<std::size_t>(camera.width) * camera.height) {
    struct Entry {
      bool behind;  ///< the ball lies wholly behind the plane
      /// Sorting key: for a ball behind the plane the depth of its nearest point, otherwise -radius.
      double key;
      std::size_t ball;
      auto operator<=>(const Entry&) const = default;
    };
    std::vector<Entry> order;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const Vector3 center = balls[i].center_m;
      const double r = balls[i].radius_m, z = (center - camera.eye).dot(camera.forward);
      const double above = cut ? (center - cut->point).dot(cut->normal) : -r;
      if (!(r > 0.0) || !(z > 1.01 * r) || above > r) continue;
      const bool crosses = above > -r;
      order.push_back({.behind = !crosses, .key = crosses ? -r : z - r, .ball = i});
    }
    std::ranges::sort(order);
    for (const Entry& entry : order) Draw(entry.ball);
  }

  [[nodiscard]] const Hit& At(int x, int y) const {
    return hits_[static_cast<std::size_t>(y) * camera_.width + x];
  }

 private:
  static constexpr int kTile = 16;  ///< pixels along a side
  struct Tile {
    double farthest_m{std::numeric_limits<double>::infinity()};  ///< greatest depth of the tile's hits
    /// Whether each pixel shows the cutting plane.
    bool done{false};
  };

  /// Draws a ball in the tiles that its outline may touch.
  void Draw(std::size_t index) {
    const double r = balls_[index].radius_m;
    const Vector3 to_center = Vector3(balls_[index].center_m) - camera_.eye;
    const double z = to_center.dot(camera_.forward);
    const Vector3 middle = camera_.Project(balls_[index].center_m);
    // factor 1.2: balls are seen at up to 30 degrees from the camera's direction
    const double reach = camera_.focal_px * r / (z - r) * 1.2 + 1.0;
    const int i0 = static_cast<int>(std::max(middle.x() - reach, 0.0)) / kTile;
    const int i1 = static_cast<int>(std::min(middle.x() + reach, camera_.width - 1.0));
    const int j0 = static_cast<int>(std::max(middle.y() - reach, 0.0)) / kTile;
    const int j1 = static_cast<int>(std::min(middle.y() + reach, camera_.height - 1.0));
    for (int j = j0; j * kTile <= j1; ++j)
      for (int i = i0; i * kTile <= i1; ++i) {
        Tile& tile = tiles_[static_cast<std::size_t>(j) * columns_ + i];
        if (!tile.done && z - r < tile.farthest_m) DrawInTile(index, to_center, i * kTile, j * kTile, tile);
      }
  }

  /// Intersects the rays of a tile's pixels with a ball, and stores each hit that is nearer than the pixel's
  /// earlier hit.
  void DrawInTile(std::size_t index, const Vector3& to_center, int x0, int y0, Tile& tile) {
    const double r = balls_[index].radius_m, c2 = to_center.squaredNorm() - r * r;
    bool changed = false;
    const int x1 = std::min(x0 + kTile, camera_.width), y1 = std::min(y0 + kTile, camera_.height);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        Hit& best = hits_[static_cast<std::size_t>(y) * camera_.width + x];
        if (best.in_plane) continue;
        const Vector3 ray = camera_.Ray(x + 0.5, y + 0.5);
        // Solve |t ray - to_center|² = r² for the depth t.
        const double d2 = ray.squaredNorm(), dc = ray.dot(to_center);
        const double discriminant = dc * dc - d2 * c2;
        if (discriminant < 0.0) continue;
        const double root = std::sqrt(discriminant);
        const double in = (dc - root) / d2, out = (dc + root) / d2;
        double plane = -std::numeric_limits<double>::infinity();
        if (cut_) {
          // The eye is in the half-space that is removed, so the ray enters the bone where it crosses the
          // plane.
          const double along = ray.dot(cut_->normal);
          if (!(along < 0.0)) continue;
          plane = (cut_->point - camera_.eye).dot(cut_->normal) / along;
        }
        if (out <= plane || std::max(in, plane) >= best.depth_m) continue;
        best = {.depth_m = std::max(in, plane), .ball = index, .in_plane = in < plane};
        changed = true;
      }
    if (!changed) return;
    tile = {.farthest_m = 0.0, .done = true};
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        const Hit& hit = At(x, y);
        tile.farthest_m = std::max(tile.farthest_m, hit.depth_m);
        tile.done = tile.done && hit.in_plane;
      }
  }

  std::span<const Ball> balls_;
  const report::Camera& camera_;
  const std::optional<CutAway>& cut_;
  int columns_;
  std::vector<Tile> tiles_;
  std::vector<Hit> hits_;
};

/// Bounding box of the balls.
Eigen::AlignedBox3d BoxOf(const simulation::Bone& bone) {
  Eigen::AlignedBox3d box;
  for (const Ball& ball : bone.balls) {
    box.extend(Vector3(ball.center_m) + Vector3::Constant(ball.radius_m));
    box.extend(Vector3(ball.center_m) - Vector3::Constant(ball.radius_m));
  }
  return box;
}

}  // namespace

CutAway MiddlePlane(const simulation::Bone& bone) {
  const Eigen::AlignedBox3d box = BoxOf(bone);
  Eigen::Index thinnest = 0;
  box.sizes().minCoeff(&thinnest);
  CutAway plane{.point = box.center(), .normal = Vector3::Unit(thinnest)};
  if (bone.site.radius_m > 0.0) {
    const Vector3 axis = bone.site.axis;
    Vector3 across = plane.normal - plane.normal.dot(axis) * axis;
    // the site's axis is along the thinnest extent: take any plane that contains the axis
    if (across.norm() < 0.3) {
      const Vector3 other = Vector3::Unit((thinnest + 1) % 3);
      across = other - other.dot(axis) * axis;
    }
    plane = {.point = bone.site.center_m, .normal = across.normalized()};
  }
  return plane;
}

report::Camera PackingCamera(const simulation::Bone& bone, const CutAway& plane, int width, int height) {
  const Eigen::AlignedBox3d box = BoxOf(bone);
  // Up is the direction of the site's axis, or of the longest extent.
  Eigen::Index longest = 0;
  box.sizes().maxCoeff(&longest);
  Vector3 up = bone.site.radius_m > 0.0 ? Vector3(bone.site.axis) : Vector3(Vector3::Unit(longest));
  up -= up.dot(plane.normal) * plane.normal;
  // For a cube the longest extent may be the direction of the normal as well.
  if (up.norm() < 0.1) up = plane.normal.unitOrthogonal();
  up.normalize();
  const Vector3 side = up.cross(plane.normal);
  const Vector3 towards = (plane.normal + 0.28 * up + 0.22 * side).normalized();
  const double far_m = 3.0 * box.diagonal().norm();
  report::Camera camera =
      report::LookAt(box.center() + far_m * towards, box.center(), up, 1.0, width, height);

  // Scale and shift so that all balls' outlines fill the picture, except for a margin.
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Ball& ball : bone.balls) {
    const Vector3 at = camera.Project(ball.center_m);
    const double r = ball.radius_m / at.z();
    low = low.cwiseMin(at - Vector3::Constant(r));
    high = high.cwiseMax(at + Vector3::Constant(r));
  }
  constexpr double kMargin = 0.96;
  camera.focal_px = kMargin * std::min(width / (high.x() - low.x()), height / (high.y() - low.y()));
  camera.center_x_px = width / 2.0 - camera.focal_px * (0.5 * (low.x() + high.x()) - width / 2.0);
  camera.center_y_px = height / 2.0 - camera.focal_px * (0.5 * (low.y() + high.y()) - height / 2.0);
  return camera;
}

report::Image RenderPacking(std::span<const Ball> balls, const report::Camera& camera,
                            const std::optional<CutAway>& cut, const BallColor& color, int threads) {
  const report::Camera fine = camera.Scaled(kFine);
  const Tracer tracer(balls, fine, cut);
  const Vector3 key_light = (-0.45 * camera.right + 0.65 * camera.up - 0.62 * camera.forward).normalized();
  // Returns the colour at a place p. On a ball's surface it is shaded by the surface's normal. On a cut face
  // it is flat, with a darker rim.
  const auto shade = [&](const Hit& hit, const Vector3& p, const Vector3& base) -> Vector3 {
    const Vector3 c = balls[hit.ball].center_m;
    const double r = balls[hit.ball].radius_m;
    if (hit.in_plane) {
      const double h = (c - cut->point).dot(cut->normal),
                   disc_radius_m = std::sqrt(std::max(r * r - h * h, 1e-18));
      const double from_rim_m = disc_radius_m - (p - (c - h * cut->normal)).norm();
      const double rim_m =
          std::min(0.12 * disc_radius_m, 1.2 * hit.depth_m / camera.focal_px);  // at most 1.2 pixels wide
      return base * (from_rim_m < rim_m ? 0.7 : 1.0);
    }
    const Vector3 n = (p - c).normalized();
    const double direct = std::max(0.0, n.dot(key_light)), facing = std::max(0.0, -n.dot(camera.forward));
    // the inside of the cut bone is darker with its depth
    const double light = cut ? std::exp((p - cut->point).dot(cut->normal) / (3.0 * r + 1e-3)) : 1.0;
    // ambient light, light from the camera, and the key light
    return base * (0.25 + 0.35 * facing + 0.45 * direct) * (0.55 + 0.45 * light);
  };

  report::Image image{.width = camera.width, .height = camera.height};
  image.rgb.resize(3 * static_cast<std::size_t>(camera.width) * camera.height);
  const auto draw_row = [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      Vector3 sum = Vector3::Zero(), base = Vector3::Ones();
      // colours may be slow to compute: compute one colour for successive samples of the same ball
      const Hit* colored = nullptr;
      for (int s = 0; s < kFine * kFine; ++s) {
        const int u = kFine * x + s % kFine, v = kFine * y + s / kFine;
        const Hit& hit = tracer.At(u, v);
        if (!std::isfinite(hit.depth_m)) {
          sum += Vector3::Ones();
          continue;
        }
        const Vector3 p = camera.eye + hit.depth_m * fine.Ray(u + 0.5, v + 0.5);
        if (!colored || colored->ball != hit.ball) base = color(hit.ball, p);
        colored = &hit;
        sum += shade(hit, p, base);
      }
      for (int k = 0; k < 3; ++k)
        image.rgb[3 * (static_cast<std::size_t>(y) * camera.width + x) + k] =
            ToByte(sum[k] / (kFine * kFine));
    }
  };
  simulation::ParallelFor(
      static_cast<std::size_t>(camera.height), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) draw_row(static_cast<int>(y));
      },
      16);
  return image;
}

Vector3 Viridis(double share) {
  // Colours at quarters of the range, linear between them (Smith and van der Walt, matplotlib, 2015).
  static const std::array<Vector3, 5> kStops{Vector3(0.267, 0.005, 0.329), Vector3(0.230, 0.322, 0.546),
                                             Vector3(0.128, 0.567, 0.551), Vector3(0.369, 0.789, 0.383),
                                             Vector3(0.993, 0.906, 0.144)};
  const double at = 4.0 * std::clamp(share, 0.0, 1.0);
  const auto i = std::min<std::size_t>(static_cast<std::size_t>(at), 3);
  const double t = at - static_cast<double>(i);
  return (1.0 - t) * kStops[i] + t * kStops[i + 1];
}

}  // namespace osteon::studies
