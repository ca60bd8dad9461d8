#include "simulation/metrics/cut_metrics.h"

#include <cmath>
#include <cstdint>

#include "simulation/tools/swept_tool.h"

namespace osteon::simulation {
namespace {

// The largest cutting ball; a tool that does not cut is measured by its first ball.
ToolBall Head(const Tool& tool) {
  const ToolBall* head = CuttingHead(tool);
  return head ? *head : tool.balls.front();
}

}  // namespace

std::optional<double> FirstHit(std::span<const Ball> balls, const Vector3& origin_m,
                               const Vector3& direction) {
  std::optional<double> first;
  for (const Ball& ball : balls) {
    const Vector3 D = Vector3(ball.center_m) - origin_m;
    const double along = D.dot(direction), gap = D.squaredNorm() - ball.radius_m * ball.radius_m;
    if (ball.radius_m <= 0.0) continue;
    if (gap <= 0.0) return 0.0;
    const double discriminant = along * along - gap;
    if (along <= 0.0 || discriminant < 0.0) continue;
    const double t = along - std::sqrt(discriminant);
    if (!first || t < *first) first = t;
  }
  return first;
}

std::vector<Ball> LiveBalls(const CarvedState& state) {
  std::vector<Ball> balls;
  const auto add = [&balls](const float* four) {
    if (four[3] > 0.0f)
      balls.push_back({.center_m = 1e-3 * Vector3(four[0], four[1], four[2]), .radius_m = 1e-3 * four[3]});
  };
  for (std::size_t i = 0; i + 3 < state.balls.size(); i += 4) add(&state.balls[i]);
  const std::size_t slots =
      state.split_balls.empty() ? 0 : state.split_slots.size() / state.split_balls.size();
  for (std::size_t j = 0; j < state.split_balls.size(); ++j)
    for (std::size_t k = 0; state.split_cuts[j] == 0 && k + 3 < slots; k += 4)
      add(&state.split_slots[j * slots + k]);
  return balls;
}

ApexDepth::ApexDepth(const Bone& bone, const Tool& tool)
    : cup_(bone.cup),
      head_T_m_(Head(tool).center_m),
      head_radius_m_(Head(tool).radius_m),
      floor_m_(FirstHit(bone.balls, bone.cup.center_m, -Vector3(bone.cup.axis)).value_or(bone.cup.radius_m)) {
}

double ApexDepth::Of(const Pose& X_GP) const {
  const double along = Vector3(cup_.axis).dot(X_GP * head_T_m_ - Vector3(cup_.center_m));
  return head_radius_m_ - along - floor_m_;
}

double SweptVolume(const Solid& solid, const Tool& tool, std::span<const Pose> X_GP, double cell_m) {
  const SweptTool swept(tool, X_GP);
  const Eigen::AlignedBox3d cells = swept.Bounds().intersection(solid.Bounds());
  if (swept.empty() || cells.isEmpty()) return 0.0;
  const Eigen::Vector3i count = (cells.sizes() / cell_m).array().ceil().max(1.0).cast<int>();
  const Vector3 step = cells.sizes().array() / count.cast<double>().array();
  std::int64_t inside = 0;
  for (int i = 0; i < count.x(); ++i)
    for (int j = 0; j < count.y(); ++j)
      for (int k = 0; k < count.z(); ++k) {
        const Vector3 p = cells.min() + step.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        if (swept.SignedDistance(p) < 0.0 && solid.SignedDistance(p) < 0.0) ++inside;
      }
  return static_cast<double>(inside) * step.prod();
}

}  // namespace osteon::simulation
