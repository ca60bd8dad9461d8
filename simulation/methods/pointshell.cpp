#include "simulation/methods/pointshell.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"
#include "simulation/packing/morton.h"

namespace osteon::simulation {

Pointshell MakePointshell(const Tool& tool, double spacing_m) {
  CheckRangeMm("pointshell: spacing", spacing_m, 0.01e-3, 5e-3);
  constexpr double kMaxPoints = 10e6;
  Pointshell shell;
  for (std::size_t t = 0; t < tool.balls.size(); ++t) {
    const ToolBall& ball = tool.balls[t];
    // one point for each square of the spacing on the ball's surface, at least 12 points
    const double wanted = std::max(
        12.0, std::ceil(4.0 * std::numbers::pi * ball.radius_m * ball.radius_m / (spacing_m * spacing_m)));
    if (static_cast<double>(shell.points.size()) + wanted > kMaxPoints)
      throw std::invalid_argument(fmt::format(
          "pointshell: found a spacing of {:g} mm, accepted up to {:g} points", spacing_m * 1e3, kMaxPoints));
    const auto count = static_cast<std::size_t>(wanted);
    for (std::size_t i = 0; i < count; ++i) {
      // Fibonacci spiral: equal steps in height, and a golden-ratio turn between neighbours
      const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(count);
      const double angle = 2.0 * std::numbers::pi * std::numbers::phi * static_cast<double>(i);
      const double ring_radius = std::sqrt(1.0 - z * z);
      const Vector3 out(ring_radius * std::cos(angle), ring_radius * std::sin(angle), z);
      const Vector3 p = Vector3(ball.center_m) + ball.radius_m * out;
      const bool hidden = std::ranges::any_of(tool.balls, [&](const ToolBall& other) {
        return &other != &ball && (p - Vector3(other.center_m)).norm() < other.radius_m;
      });
      if (!hidden) shell.points.push_back({.p_m = p, .n = -out, .cutting = ball.cutting});
    }
  }
  Eigen::AlignedBox3d box;
  for (const Pointshell::Point& point : shell.points) box.extend(point.p_m);
  SortAlongMortonCurve(shell.points, box, [](const Pointshell::Point& point) { return point.p_m; });
  // divide the curve into runs of neighbouring points, each with a bounding ball
  for (std::size_t begin = 0; begin < shell.points.size(); begin += Pointshell::kRun) {
    const std::size_t end = std::min(begin + Pointshell::kRun, shell.points.size());
    Eigen::AlignedBox3d around;
    for (std::size_t i = begin; i < end; ++i) around.extend(shell.points[i].p_m);
    double radius = 0.0;
    for (std::size_t i = begin; i < end; ++i)
      radius = std::max(radius, (shell.points[i].p_m - around.center()).norm());
    shell.runs.push_back({.begin = begin, .end = end, .center_m = around.center(), .radius_m = radius});
  }
  return shell;
}

}  // namespace osteon::simulation
