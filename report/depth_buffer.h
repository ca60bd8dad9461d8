#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kinematics/spatial.h"

namespace osteon::report {

/// A pinhole camera in G. Pixel (0, 0) is top left; +y of the view is up.
struct Camera {
  Vector3 eye{0, 0, 1}, right{Vector3::UnitX()}, up{Vector3::UnitY()}, forward{-Vector3::UnitZ()};
  double focal_px{1000.0};
  double center_x_px{450.0}, center_y_px{350.0};
  int width{900}, height{700};

  /// Returns the direction of the ray through a point of the picture, scaled so that its component along
  /// `forward` is 1.
  [[nodiscard]] Vector3 Ray(double x_px, double y_px) const {
    return forward + (x_px - center_x_px) / focal_px * right - (y_px - center_y_px) / focal_px * up;
  }
  /// Returns the picture coordinates of p [px], and its depth along `forward` [m].
  [[nodiscard]] Vector3 Project(const Vector3& p_G) const {
    const Vector3 p = p_G - eye;
    const double z = p.dot(forward);
    return {center_x_px + focal_px * p.dot(right) / z, center_y_px - focal_px * p.dot(up) / z, z};
  }
  /// Returns the same view with `factor` times as many pixels in each direction.
  [[nodiscard]] Camera Scaled(int factor) const;
};

/// Makes a camera at `eye` that looks at `target`; the picture's vertical axis follows `up`, which must not
/// be parallel to the view.
[[nodiscard]] Camera LookAt(const Vector3& eye, const Vector3& target, const Vector3& up, double focal_px,
                            int width, int height);

/// For each pixel's centre, the depth of the first surface along the camera's axis; kNothing if there is
/// none.
struct DepthBuffer {
  static constexpr float kNothing = 1e30f;
  int width{0}, height{0};
  std::vector<float> depth_m{};

  [[nodiscard]] float At(int x, int y) const { return depth_m[static_cast<std::size_t>(y) * width + x]; }
  [[nodiscard]] bool Seen(int x, int y) const { return At(x, y) < kNothing; }
};

/// A surface in G, with a normal of unit length at each vertex.
struct BoneMesh {
  std::vector<Eigen::Vector3f> vertices_m{}, normals{};
  std::vector<std::array<std::uint32_t, 3>> triangles{};  ///< counter-clockwise seen from outside
};

/// Computes the depths of a mesh. A triangle that is partly behind the camera is left out.
/// @param normals  null, or receives the interpolated normal of the visible surface at each pixel, in G
[[nodiscard]] DepthBuffer RenderDepth(const BoneMesh& mesh, const Camera& camera,
                                      std::vector<Eigen::Vector3f>* normals = nullptr);

}  // namespace osteon::report
