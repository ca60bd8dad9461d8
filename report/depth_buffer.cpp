#include "report/depth_buffer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace osteon::report {

Camera Camera::Scaled(int factor) const {
  Camera camera = *this;
  camera.focal_px *= factor;
  camera.center_x_px *= factor;
  camera.center_y_px *= factor;
  camera.width *= factor;
  camera.height *= factor;
  return camera;
}

Camera LookAt(const Vector3& eye, const Vector3& target, const Vector3& up, double focal_px, int width,
              int height) {
  Camera camera{.eye = eye,
                .focal_px = focal_px,
                .center_x_px = width / 2.0,
                .center_y_px = height / 2.0,
                .width = width,
                .height = height};
  camera.forward = (target - eye).normalized();
  camera.right = camera.forward.cross(up).normalized();
  camera.up = camera.right.cross(camera.forward);
  return camera;
}

namespace {

/// A vertex projected into the picture: its pixel coordinates, and 1 / depth, because 1 / depth is linear
/// over the picture.
struct Projected {
  double x, y, inverse_z;
};

/// Twice the signed area of the triangle of a, b and a point. The sign tells on which side of the line ab the
/// point lies.
double Side(const Projected& a, const Projected& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

}  // namespace

DepthBuffer RenderDepth(const BoneMesh& mesh, const Camera& camera, std::vector<Eigen::Vector3f>* normals) {
  DepthBuffer buffer{.width = camera.width, .height = camera.height};
  buffer.depth_m.assign(static_cast<std::size_t>(camera.width) * camera.height, DepthBuffer::kNothing);
  if (normals) normals->assign(buffer.depth_m.size(), Eigen::Vector3f::Zero());
  std::vector<Projected> projected;
  projected.reserve(mesh.vertices_m.size());
  for (const Eigen::Vector3f& p : mesh.vertices_m) {
    const Vector3 at = camera.Project(p.cast<double>());
    projected.push_back({.x = at.x(), .y = at.y(), .inverse_z = at.z() > 0.0 ? 1.0 / at.z() : -1.0});
  }
  for (const auto& triangle : mesh.triangles) {
    const Projected &a = projected[triangle[0]], &b = projected[triangle[1]], &c = projected[triangle[2]];
    if (!(std::min({a.inverse_z, b.inverse_z, c.inverse_z}) > 0.0)) continue;
    const double area = Side(a, b, c.x, c.y);  // twice the triangle's signed area
    if (area == 0.0 || !std::isfinite(area)) continue;
    // the pixels of the triangle's bounding box
    const auto [x0, x1] = std::minmax({a.x, b.x, c.x});
    const auto [y0, y1] = std::minmax({a.y, b.y, c.y});
    if (!(x1 >= 0.0 && y1 >= 0.0 && x0 < camera.width && y0 < camera.height)) continue;
    const int i0 = static_cast<int>(std::max(x0 - 0.5, 0.0)), j0 = static_cast<int>(std::max(y0 - 0.5, 0.0));
    const int i1 = static_cast<int>(std::min(x1 + 0.5, camera.width - 1.0));
    const int j1 = static_cast<int>(std::min(y1 + 0.5, camera.height - 1.0));
    for (int j = j0; j <= j1; ++j) {
      for (int i = i0; i <= i1; ++i) {
        // barycentric weights of a, b and c at the pixel's centre
        const double u = Side(b, c, i + 0.5, j + 0.5) / area, v = Side(c, a, i + 0.5, j + 0.5) / area;
        const double w = 1.0 - u - v;
        if (u < 0.0 || v < 0.0 || w < 0.0) continue;
        const double inverse_z = u * a.inverse_z + v * b.inverse_z + w * c.inverse_z;
        const std::size_t pixel = static_cast<std::size_t>(j) * camera.width + i;
        const auto z = static_cast<float>(1.0 / inverse_z);
        if (z >= buffer.depth_m[pixel]) continue;
        buffer.depth_m[pixel] = z;
        if (!normals) continue;
        // weight of a vertex on the surface in space, which differs from the weight in the picture by
        // perspective
        const auto share = [&](double s, const Projected& of) {
          return static_cast<float>(s * of.inverse_z / inverse_z);
        };
        (*normals)[pixel] =
            (share(u, a) * mesh.normals[triangle[0]] + share(v, b) * mesh.normals[triangle[1]] +
             share(w, c) * mesh.normals[triangle[2]])
                .normalized();
      }
    }
  }
  return buffer;
}

}  // namespace osteon::report
