#include "simulation/engine/tool_reach.h"

#include <algorithm>
#include <utility>

namespace osteon::simulation {
namespace {

// The radius of each sphere is larger by this [m] than the frame needs, so that later frames can use the
// lists, too.
constexpr double kSpare_m = 1e-3;
// Allowance [m] for rounding of balls, whenever they shrink, and of the distances that are compared below.
constexpr double kRounding_m = 10e-6;

}  // namespace

void ToolReach::Update(const Tool& tool, const ToolPoints& from, const ToolPoints& to, double farther_m,
                       const std::vector<BallState>& balls, const std::vector<MassPoint>& points) {
  std::vector<Sphere> needed;
  needed.reserve(tool.balls.size());
  for (std::size_t t = 0; t < tool.balls.size(); ++t)
    needed.push_back(
        {.centre_m = 0.5 * (from[t] + to[t]),
         .radius_m = 0.5 * (to[t] - from[t]).norm() + tool.balls[t].radius_m + farther_m + kRounding_m});
  // the lists stay valid while each tool ball's sphere encloses the sphere that is needed now
  if (spheres_.size() == needed.size()) {
    bool inside = true;
    for (std::size_t t = 0; t < needed.size() && inside; ++t)
      inside =
          (needed[t].centre_m - spheres_[t].centre_m).norm() + needed[t].radius_m <= spheres_[t].radius_m;
    if (inside) return;
  }

  spheres_ = std::move(needed);
  Eigen::AlignedBox3d box;
  for (Sphere& sphere : spheres_) {
    sphere.radius_m += kSpare_m;
    box.extend(sphere.centre_m);
  }
  enclosing_ = {.centre_m = box.center(), .radius_m = 0.0};
  for (const Sphere& sphere : spheres_)
    enclosing_.radius_m =
        std::max(enclosing_.radius_m, (sphere.centre_m - enclosing_.centre_m).norm() + sphere.radius_m);
  balls_ = {};
  points_ = {};
  for (std::size_t b = 0; b < balls.size(); ++b)
    if (balls[b].radius_m > 0.0) AddNear(b, balls[b].center_m, balls[b].radius_m, balls_);
  for (std::size_t i = 0; i < points.size(); ++i) AddNear(i, points[i].p_m, 0.0, points_);
  balls_.first.push_back(balls_.tool.size());
  points_.first.push_back(points_.tool.size());
}

// Adds a bone ball, or a mass point (radius 0), if any tool ball can meet it. Stores it with all tool balls
// that can meet it.
void ToolReach::AddNear(std::size_t item, const Vector3& p_m, double radius_m, NearItems& near) const {
  const auto meets = [&](const Sphere& sphere) {
    const double within_m = sphere.radius_m + radius_m;
    return (p_m - sphere.centre_m).squaredNorm() <= within_m * within_m;
  };
  if (!meets(enclosing_)) return;
  const std::size_t first = near.tool.size();
  for (std::size_t t = 0; t < spheres_.size(); ++t)
    if (meets(spheres_[t])) near.tool.push_back(static_cast<std::uint32_t>(t));
  if (near.tool.size() == first) return;
  near.items.push_back(item);
  near.first.push_back(first);
}

bool ToolReach::Holds(const Tool& tool, const ToolPoints& at) const {
  if (spheres_.size() != tool.balls.size()) return false;
  for (std::size_t t = 0; t < spheres_.size(); ++t)
    if ((at[t] - spheres_[t].centre_m).norm() + tool.balls[t].radius_m > spheres_[t].radius_m) return false;
  return true;
}

}  // namespace osteon::simulation
