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

DepthBuffer RenderDepth(std::span<const simulation::Ball> balls, const Camera& camera) {
  DepthBuffer buffer{.width = camera.width, .height = camera.height};
  buffer.depth_m.assign(static_cast<std::size_t>(camera.width) * camera.height, DepthBuffer::kNothing);

  // front to back, so that most hidden pixels are rejected before the root is computed
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double nearest_m =
        (Vector3(balls[i].center_m) - camera.eye).dot(camera.forward) - balls[i].radius_m;
    if (std::isfinite(nearest_m)) order.emplace_back(nearest_m, i);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [nearest_m, index] : order) {
    const simulation::Ball& ball = balls[index];
    const double r = ball.radius_m;
    const Vector3 to_center = Vector3(ball.center_m) - camera.eye;
    const double z = to_center.dot(camera.forward);
    if (!(r > 0.0) || !(z > 1.01 * r)) continue;
    const double x = to_center.dot(camera.right), y = to_center.dot(camera.up);

    // the cone that touches the ball, bounded by the ball's box at its nearest depth
    const double near = z - r, f = camera.focal_px;
    const auto low = [&](double a) { return f * (a - r) / (a - r < 0.0 ? near : z + r); };
    const auto high = [&](double a) { return f * (a + r) / (a + r > 0.0 ? near : z + r); };
    const double x0 = camera.center_x_px + low(x), x1 = camera.center_x_px + high(x);
    const double y0 = camera.center_y_px - high(y), y1 = camera.center_y_px - low(y);
    if (!(x1 >= 0.0 && y1 >= 0.0 && x0 < camera.width && y0 < camera.height)) continue;
    const int i0 = static_cast<int>(std::max(x0 - 0.5, 0.0)), j0 = static_cast<int>(std::max(y0 - 0.5, 0.0));
    const int i1 = static_cast<int>(std::min(x1 + 0.5, camera.width - 1.0));
    const int j1 = static_cast<int>(std::min(y1 + 0.5, camera.height - 1.0));

    // |s d - c|^2 = r^2 with d = (dx, dy, 1) in the camera's axes, so that s is the depth
    const double c2 = to_center.squaredNorm() - r * r;
    for (int j = j0; j <= j1; ++j) {
      const double dy = (camera.center_y_px - (j + 0.5)) / f;
      float* row = buffer.depth_m.data() + static_cast<std::size_t>(j) * camera.width;
      for (int i = i0; i <= i1; ++i) {
        if (static_cast<double>(row[i]) <= nearest_m) continue;
        const double dx = (i + 0.5 - camera.center_x_px) / f;
        const double d2 = dx * dx + dy * dy + 1.0, dc = dx * x + dy * y + z;
        const double discriminant = dc * dc - d2 * c2;
        if (discriminant < 0.0) continue;
        row[i] = std::min(row[i], static_cast<float>((dc - std::sqrt(discriminant)) / d2));
      }
    }
  }
  return buffer;
}

}  // namespace osteon::report
