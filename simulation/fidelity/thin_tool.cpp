#include "simulation/fidelity/thin_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace osteon::simulation {
namespace {

/// Signed distance [m] of a place to a ball: negative inside.
double DistanceTo(const Vector3& p_m, const ToolBall& ball) {
  return (p_m - Vector3(ball.center_m)).norm() - ball.radius_m;
}

/// A sample point on a tool's surface, in T, and the area that the sample represents.
struct Place {
  Vector3 p_m;
  double area_m2;
};

/// Sample places on the surface of the union of the balls of one kind.
std::vector<Place> SurfaceOf(const std::vector<ToolBall>& balls, bool cutting) {
  constexpr int kPlaces = 200;  // number of samples of each ball
  std::vector<Place> places;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (balls[i].cutting != cutting) continue;
    for (int k = 0; k < kPlaces; ++k) {  // Fibonacci spiral: equal areas
      const double z = 1.0 - (2.0 * k + 1.0) / kPlaces,
                   angle = std::numbers::phi * 2.0 * std::numbers::pi * k, width = std::sqrt(1.0 - z * z);
      const Vector3 p = Vector3(balls[i].center_m) +
                        balls[i].radius_m * Vector3(width * std::cos(angle), width * std::sin(angle), z);
      bool covered = false;
      for (std::size_t j = 0; j < balls.size() && !covered; ++j)
        covered = j != i && balls[j].cutting == cutting && DistanceTo(p, balls[j]) < -1e-9;
      if (!covered)
        places.push_back(
            {.p_m = p, .area_m2 = 4.0 * std::numbers::pi * balls[i].radius_m * balls[i].radius_m / kPlaces});
    }
  }
  return places;
}

}  // namespace

Tool ThinTool(const Tool& tool, double gap_m) {
  if (!(gap_m >= 0.0 && std::isfinite(gap_m)))
    throw std::invalid_argument(
        fmt::format("thin tool: gap: found {:g} mm, accepted 0 and more", gap_m * 1e3));
  Tool thin = tool;
  const ToolBall* head = CuttingHead(tool);
  const auto is_head = [&](const ToolBall& ball) {
    return head != nullptr && ball.radius_m == head->radius_m &&
           Vector3(ball.center_m) == Vector3(head->center_m);
  };
  for (const bool cutting : {true, false}) {
    const std::vector<Place> surface = SurfaceOf(tool.balls, cutting);
    std::vector<ToolBall> by_size;
    for (const ToolBall& ball : tool.balls)
      if (ball.cutting == cutting && !is_head(ball)) by_size.push_back(ball);
    std::ranges::stable_sort(by_size, {}, &ToolBall::radius_m);
    // drop each ball whose absence leaves every sample of the surface within gap_m of a remaining ball
    for (const ToolBall& candidate : by_size) {
      std::vector<ToolBall> left;
      for (const ToolBall& ball : thin.balls)
        if (!(ball.cutting == cutting && ball.radius_m == candidate.radius_m &&
              Vector3(ball.center_m) == Vector3(candidate.center_m)))
          left.push_back(ball);
      const auto kept = [&](const Place& place) {
        return std::ranges::any_of(left, [&](const ToolBall& ball) {
          return ball.cutting == cutting && DistanceTo(place.p_m, ball) <= gap_m;
        });
      };
      if (std::ranges::all_of(surface, kept)) thin.balls = std::move(left);
    }
  }
  return thin;
}

double MeanCuttingGap(const Tool& tool, const Tool& thin) {
  double sum = 0.0, area = 0.0;
  for (const Place& place : SurfaceOf(tool.balls, true)) {
    double gap = std::numeric_limits<double>::infinity();
    for (const ToolBall& ball : thin.balls)
      if (ball.cutting) gap = std::min(gap, std::max(0.0, DistanceTo(place.p_m, ball)));
    sum += place.area_m2 * gap;
    area += place.area_m2;
  }
  return area > 0.0 ? sum / area : 0.0;
}

}  // namespace osteon::simulation
