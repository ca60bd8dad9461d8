#include "report/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace osteon::report {
namespace {

using simulation::Ball;
using Vector3f = Eigen::Vector3f;
using Vector4f = Eigen::Vector4f;

/// One value per pixel.
template <typename T>
struct Layer {
  int width, height;
  std::vector<T> values;
  Layer(int w, int h, const T& fill) : width(w), height(h), values(static_cast<std::size_t>(w) * h, fill) {}
  T& operator()(int x, int y) { return values[static_cast<std::size_t>(y) * width + x]; }
  const T& operator()(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

/// Calls draw(y) for each row of a picture, on all cores. Each call writes only to its own row.
template <typename Draw>
void ForEachRow(int rows, const Draw& draw) {
  simulation::ParallelFor(
      static_cast<std::size_t>(rows), 0,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y) draw(static_cast<int>(y));
      },
      16);
}

/// Rounds to the nearest integer. Faster than std::lround, which is a function call.
int RoundToInt(float value) { return static_cast<int>(value + (value < 0.0f ? -0.5f : 0.5f)); }

/// A plane that approximates the depth around a pixel: z(dx, dy) = z + gx dx + gy dy, with dx, dy in pixels.
struct LocalPlane {
  float z{DepthBuffer::kNothing}, gx{0.0f}, gy{0.0f};
};

/// Makes the plane of the surface that is visible at a pixel. An interpolated normal may point away from the
/// camera at an outline; it is then replaced by one at a grazing angle.
LocalPlane PlaneAt(float z, const Vector3f& normal_G, const Camera& camera, int x, int y) {
  constexpr float kGrazing = -0.05f;  // largest cosine between normal and ray
  const auto along = [&](const Vector3& axis) { return normal_G.dot(axis.cast<float>()); };
  const Vector3f n(along(camera.right), along(camera.up), -along(camera.forward));
  const auto f = static_cast<float>(camera.focal_px);
  const Vector3f ray(static_cast<float>((x + 0.5 - camera.center_x_px) / camera.focal_px),
                     static_cast<float>((camera.center_y_px - (y + 0.5)) / camera.focal_px), -1.0f);
  // the plane n·p = const, for points p = z ray
  const float facing = std::min(n.dot(ray), kGrazing * ray.norm());
  return {.z = z, .gx = -z * n.x() / (f * facing), .gy = z * n.y() / (f * facing)};
}

/// Returns the normal in the camera's axes (right, up, towards the viewer).
Vector3f NormalOf(const LocalPlane& plane, const Camera& camera, int x, int y) {
  const float f = static_cast<float>(camera.focal_px);
  const float rx = static_cast<float>((x + 0.5 - camera.center_x_px) / camera.focal_px);
  const float ry = static_cast<float>((camera.center_y_px - (y + 0.5)) / camera.focal_px);
  // tangents of p = z (rx, ry, 1) along the picture's axes; depth grows away from the viewer
  const Vector3f along_x(plane.gx * rx + plane.z / f, plane.gx * ry, -plane.gx);
  const Vector3f along_y(plane.gy * rx, plane.gy * ry - plane.z / f, -plane.gy);
  const Vector3f normal = along_y.cross(along_x);
  const float size = normal.norm();
  return size > 0.0f ? Vector3f(normal / size) : Vector3f::UnitZ();
}

/// Returns the fraction of the sky that the surface around a pixel leaves open, 0 … 1. In each direction the
/// steepest neighbour above the tangent plane blocks the sky up to its elevation. Only the depths of the
/// neighbours are read, because their planes would not fit into the cache as well.
float OpenSky(const DepthBuffer& depth, const Camera& camera, const Vector3f& normal, int x, int y) {
  // distances of the neighbours from the pixel, on the surface
  constexpr std::array<float, 5> kRadii_m{0.7e-3f, 1.8e-3f, 4e-3f, 8e-3f, 14e-3f};
  constexpr int kDirections = 12;
  static const std::array<Eigen::Vector2f, kDirections> directions = [] {
    std::array<Eigen::Vector2f, kDirections> made;
    for (int d = 0; d < kDirections; ++d) {
      const float angle = 2.0f * std::numbers::pi_v<float> * (static_cast<float>(d) + 0.5f) / kDirections;
      made[d] = {std::cos(angle), std::sin(angle)};
    }
    return made;
  }();
  const float here = depth.At(x, y);
  const float f = static_cast<float>(camera.focal_px), px_per_m = f / here;
  const float center_x = static_cast<float>(camera.center_x_px) - 0.5f,
              center_y = static_cast<float>(camera.center_y_px) - 0.5f;
  const auto position = [&](int u, int v, float z) {
    const float m_per_px = z / f;
    return Vector3f(m_per_px * (static_cast<float>(u) - center_x),
                    m_per_px * (center_y - static_cast<float>(v)), -z);
  };
  const Vector3f p = position(x, y, here);
  float blocked = 0.0f;
  for (const Eigen::Vector2f& direction : directions) {
    // sine of the elevation up to which the sky is blocked; it starts at the unevenness of the surface's grid
    float horizon = 0.06f;
    for (const float radius : kRadii_m) {
      const int u = x + RoundToInt(direction.x() * radius * px_per_m);
      const int v = y + RoundToInt(direction.y() * radius * px_per_m);
      if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) break;
      const float there = depth.At(u, v);
      if (there >= DepthBuffer::kNothing) continue;
      const Vector3f to = position(u, v, there) - p;
      const float rise = to.dot(normal), squared = to.squaredNorm();
      // most neighbours are below the present horizon: skip the square root
      if (rise <= 0.0f || rise * rise <= horizon * horizon * squared || squared < 1e-12f) continue;
      const float distance = std::sqrt(squared);
      // if a neighbour is in fact much farther away than its distance in the picture (it is nearer to the
      // viewer), it blocks less of the sky
      const float fade = std::clamp(2.0f - distance / (2.0f * radius), 0.0f, 1.0f);
      horizon = std::max(horizon, fade * rise / distance);
    }
    blocked += horizon * horizon;
  }
  return 1.0f - blocked / kDirections;
}

/// Returns the fraction of light that reaches a point, 0 … 1: bone between light and point casts a shadow,
/// whose edge is softened over neighbouring pixels of the shadow map.
float Lit(const DepthBuffer& shadow, const Camera& light, const Vector3& p_G) {
  // number of the shadow map's pixels, to each side, over which a shadow's edge is softened
  constexpr int kSoft = 3;
  const Vector3 at = light.Project(p_G);
  const int x = static_cast<int>(at.x()), y = static_cast<int>(at.y());
  float lit = 0.0f;
  int count = 0;
  for (int v = y - kSoft; v <= y + kSoft; ++v)
    for (int u = x - kSoft; u <= x + kSoft; ++u) {
      ++count;
      const bool outside = u < 0 || v < 0 || u >= shadow.width || v >= shadow.height;
      // p is dark if the first surface that the light meets is 0.9 mm nearer to the light than p, and lit if
      // that surface is at most 0.4 mm nearer
      const double clearance_m = outside ? 1.0 : shadow.At(u, v) - at.z() + 0.9e-3;
      lit += static_cast<float>(std::clamp(clearance_m / 0.5e-3, 0.0, 1.0));
    }
  return lit / static_cast<float>(count);
}

// sRGB's transfer curve, approximated by a power of 2.2; components 0 … 1.
float ToLinear(double srgb) { return static_cast<float>(std::pow(srgb, 2.2)); }
// The inverse of ToLinear, as a byte.
std::uint8_t ToSrgb(float linear) {
  return static_cast<std::uint8_t>(
      std::lround(255.0f * std::pow(std::clamp(linear, 0.0f, 1.0f), 1.0f / 2.2f)));
}

/// Returns each pixel's colour by material, smoothed over neighbouring pixels of about the same depth.
Layer<Vector3f> MaterialColors(const simulation::Bone& bone, const MaterialMap& materials,
                               const Camera& camera, const DepthBuffer& depth,
                               const Layer<LocalPlane>& planes) {
  // the material is looked up this far below the surface, inside the bone
  constexpr double kBelow_m = 0.3e-3;
  constexpr int kReach = 5;  // pixels to each side over which colours are smoothed
  std::array<Vector3f, 256> table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Vector3 color = MaterialColor(bone, static_cast<simulation::MaterialIndex>(i));
    table[i] = {ToLinear(color.x()), ToLinear(color.y()), ToLinear(color.z())};
  }
  // the fourth component is 1: after a weighted sum it is the sum of the weights
  Layer<Vector4f> raw(planes.width, planes.height, Vector4f(0.6f, 0.57f, 0.5f, 1.0f));
  ForEachRow(planes.height, [&](int y) {
    for (int x = 0; x < planes.width; ++x) {
      if (planes(x, y).z >= DepthBuffer::kNothing) continue;
      const Vector3f n = NormalOf(planes(x, y), camera, x, y);
      const Vector3 n_G = n.x() * camera.right + n.y() * camera.up - n.z() * camera.forward;
      const Vector3 p_G = camera.eye + planes(x, y).z * camera.Ray(x + 0.5, y + 0.5) - kBelow_m * n_G;
      if (const auto material = materials.At(p_G)) raw(x, y).head<3>() = table[*material];
    }
  });
  Layer<Vector3f> smooth(planes.width, planes.height, Vector3f(0.6f, 0.57f, 0.5f));
  ForEachRow(planes.height, [&](int y) {
    for (int x = 0; x < planes.width; ++x) {
      const float z = depth.At(x, y);
      if (z >= DepthBuffer::kNothing) continue;
      const int left = std::max(x - kReach, 0), right = std::min(x + kReach, planes.width - 1);
      Vector4f sum = Vector4f::Zero();
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, planes.height - 1); ++v)
        for (int u = left; u <= right; ++u) {
          if (std::abs(depth.At(u, v) - z) > 1.5e-3f) continue;  // the neighbour belongs to another surface
          const auto weight =
              static_cast<float>((kReach + 1 - std::abs(u - x)) * (kReach + 1 - std::abs(v - y)));
          sum += weight * raw(u, v);
        }
      smooth(x, y) = sum.head<3>() / sum.w();
    }
  });
  return smooth;
}

}  // namespace

Camera CupCamera(const simulation::Bone& bone, const RenderParams& params) {
  Vector3 axis = Vector3(bone.site.axis).normalized();
  if (!axis.allFinite() || axis.norm() < 0.5) axis = Vector3::UnitZ();
  const Vector3 other = std::abs(axis.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 u = (other - other.dot(axis) * axis).normalized(), w = axis.cross(u);
  const Vector3 side = std::cos(params.turn_rad) * u - std::sin(params.turn_rad) * w;
  // from the cup's centre towards the eye
  const Vector3 towards = std::cos(params.tilt_rad) * axis - std::sin(params.tilt_rad) * w +
                          0.25 * std::sin(params.tilt_rad) * side;
  const double reach_m = SiteReach(bone, params.reach_in_cup_radii);
  const Vector3 center = bone.site.center_m;
  Camera camera =
      LookAt(center + 5.0 * reach_m * towards.normalized(), center, axis, 1.0, params.width, params.height);

  // choose focal length and centre so that the surroundings of the cup fill the picture up to a margin
  Vector3 low = Vector3::Constant(1e9), high = -low;
  for (const Ball& ball : bone.balls) {
    const Vector3 c = ball.center_m;
    if (!c.allFinite() || (c - center).norm() > reach_m) continue;
    const Vector3 at = camera.Project(c);
    const double r = ball.radius_m / at.z();
    low = low.cwiseMin(at - Vector3::Constant(r));
    high = high.cwiseMax(at + Vector3::Constant(r));
  }
  const bool any = low.x() <= high.x();
  if (!any) {
    camera.focal_px = params.width;
    return camera;
  }
  constexpr double kMargin = 0.96;
  camera.focal_px =
      kMargin * std::min(params.width / (high.x() - low.x()), params.height / (high.y() - low.y()));
  camera.center_x_px =
      params.width / 2.0 - camera.focal_px * (0.5 * (low.x() + high.x()) - params.width / 2.0);
  camera.center_y_px =
      params.height / 2.0 - camera.focal_px * (0.5 * (low.y() + high.y()) - params.height / 2.0);
  return camera;
}

Image RenderBone(const simulation::Bone& bone, const BoneMesh& mesh, const MaterialMap& materials,
                 const Camera& camera) {
  constexpr int kFine = 2;  // number of depth samples per pixel in each direction, for smooth outlines
  std::vector<Vector3f> normals;
  const DepthBuffer depth = RenderDepth(mesh, camera, &normals),
                    fine = RenderDepth(mesh, camera.Scaled(kFine));
  Layer<LocalPlane> planes(camera.width, camera.height, {});
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (depth.Seen(x, y))
        planes(x, y) =
            PlaneAt(depth.At(x, y), normals[static_cast<std::size_t>(y) * camera.width + x], camera, x, y);
  const Layer<Vector3f> colors = MaterialColors(bone, materials, camera, depth, planes);

  // light from the upper left, far enough away to be nearly parallel
  // key: towards the light, in the camera's axes (right, up, towards the viewer)
  const Vector3f key = Vector3f(-0.55f, 0.62f, 0.56f).normalized();
  const Vector3 key_G = key.x() * camera.right + key.y() * camera.up - key.z() * camera.forward;
  const double near_m = SiteReach(bone, 3.2), far_m = 18.75 * near_m;
  const int shadow_px = 700;
  const double reach_m = 1.25 * near_m;
  const Camera light = LookAt(Vector3(bone.site.center_m) + far_m * key_G, bone.site.center_m, camera.up,
                              0.5 * shadow_px * far_m / reach_m, shadow_px, shadow_px);
  const DepthBuffer shadow = RenderDepth(mesh, light);

  Layer<Vector3f> shaded(camera.width, camera.height, Vector3f::Ones());
  ForEachRow(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      if (!depth.Seen(x, y)) continue;
      const Vector3f n = NormalOf(planes(x, y), camera, x, y);
      const float sky = OpenSky(depth, camera, n, x, y);
      const Vector3 p_G = camera.eye + planes(x, y).z * camera.Ray(x + 0.5, y + 0.5);
      const float towards = n.dot(key);
      const float direct = towards > 0.0f ? towards * Lit(shadow, light, p_G) : 0.0f;
      // light from the key direction, with gloss (Blinn's half vector); and ambient light from all around,
      // from above and from the viewer, dimmed by the surrounding bone (sky)
      const float fill = 0.5f + 0.5f * n.y();
      const Vector3f half = (key + Vector3f::UnitZ()).normalized();
      const float gloss =
          0.10f * std::pow(std::max(n.dot(half), 0.0f), 30.0f) * (direct > 0.0f ? 1.0f : 0.0f);
      const float strength = 0.60f * direct + sky * sky * (0.26f + 0.12f * fill + 0.30f * n.z());
      shaded(x, y) = colors(x, y) * strength + Vector3f::Constant(gloss * direct);
    }
  });

  // each fine depth sample gets the colour of that neighbouring pixel whose depth is nearest
  Image image{.width = camera.width, .height = camera.height};
  image.rgb.resize(3 * static_cast<std::size_t>(camera.width) * camera.height);
  ForEachRow(camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      Vector3f sum = Vector3f::Zero();
      for (int s = 0; s < kFine * kFine; ++s) {
        const float z = fine.At(kFine * x + s % kFine, kFine * y + s / kFine);
        Vector3f color = Vector3f::Ones();
        if (z < DepthBuffer::kNothing) {
          float nearest_m = DepthBuffer::kNothing;
          for (int v = std::max(y - 1, 0); v <= std::min(y + 1, camera.height - 1); ++v)
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, camera.width - 1); ++u) {
              // prefer the pixel itself to its neighbours on the same surface
              const float distance_m = std::abs(depth.At(u, v) - z) + (u == x && v == y ? 0.0f : 0.5e-3f);
              if (depth.Seen(u, v) && distance_m < nearest_m) {
                nearest_m = distance_m;
                color = shaded(u, v);
              }
            }
        }
        sum += color;
      }
      for (int k = 0; k < 3; ++k)
        image.rgb[3 * (static_cast<std::size_t>(y) * camera.width + x) + k] =
            ToSrgb(sum[k] / static_cast<float>(kFine * kFine));
    }
  });
  return image;
}

}  // namespace osteon::report
