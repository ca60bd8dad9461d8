#include "simulation/engine/tool_reach.h"

#include <algorithm>
#include <numeric>

namespace osteon::simulation {
namespace {

constexpr double kSpare_m = 1e-3;  // lists serve as long as the tool stays within this
constexpr double kRounding_m =
    10e-6;  // of balls that are rounded whenever they shrink, and of the tests here

}  // namespace

void ToolReach::Update(const Tool& tool, const ToolPoints& from, const ToolPoints& to, double farther_m,
                       const std::vector<BallState>& balls, const std::vector<MassPoint>& points) {
  Eigen::AlignedBox3d box;
  for (std::size_t t = 0; t < tool.balls.size(); ++t) box.extend(from[t]).extend(to[t]);
  const Vector3 centre_m = box.center();
  double radius_m = 0.0;
  for (std::size_t t = 0; t < tool.balls.size(); ++t)
    radius_m = std::max(
        radius_m, std::max((from[t] - centre_m).norm(), (to[t] - centre_m).norm()) + tool.balls[t].radius_m);
  radius_m += farther_m + kRounding_m;
  if (Holds(centre_m, radius_m)) return;

  centre_m_ = centre_m;
  radius_m_ = radius_m + kSpare_m;
  balls_.clear();
  points_.clear();
  for (std::size_t b = 0; b < balls.size(); ++b) {
    const double within_m = radius_m_ + balls[b].radius_m;
    if (balls[b].radius_m > 0.0 && (balls[b].center_m - centre_m_).squaredNorm() <= within_m * within_m)
      balls_.push_back(b);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if ((Vector3(points[i].p_m) - centre_m_).squaredNorm() <= radius_m_ * radius_m_) points_.push_back(i);
}

void ToolReach::TakeAll(std::size_t balls, std::size_t points) {
  balls_.resize(balls);
  std::iota(balls_.begin(), balls_.end(), std::size_t{0});
  points_.resize(points);
  std::iota(points_.begin(), points_.end(), std::size_t{0});
  Forget();
}

}  // namespace osteon::simulation
