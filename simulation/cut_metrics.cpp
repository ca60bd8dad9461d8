#include "simulation/cut_metrics.h"

#include <algorithm>
#include <cmath>

#include "simulation/cutting_math.h"

namespace osteon::simulation {
namespace {

constexpr double kPathTolerance_m = 2e-6;

// The first cutting ball is the head.
const ToolBall& Head(const Tool& tool) {
  const auto head =
      std::find_if(tool.balls.begin(), tool.balls.end(), [](const ToolBall& b) { return b.cutting; });
  return head != tool.balls.end() ? *head : tool.balls.front();
}

// Points of a path that keep it within the tolerance (Douglas and Peucker, 1973).
void Simplify(const std::vector<Vector3>& path, std::size_t first, std::size_t last,
              std::vector<bool>& keep) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{first, last}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double worst = kPathTolerance_m;
    std::size_t at = a;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double off = (path[i] - ClosestOnSegment(path[i], path[a], path[b])).norm();
      if (off > worst) {
        worst = off;
        at = i;
      }
    }
    if (at == a) continue;
    keep[at] = true;
    open.push_back({a, at});
    open.push_back({at, b});
  }
}

std::vector<Vector3> Simplified(const std::vector<Vector3>& path) {
  if (path.size() < 3) return path;
  std::vector<bool> keep(path.size(), false);
  keep.front() = keep.back() = true;
  Simplify(path, 0, path.size() - 1, keep);
  std::vector<Vector3> kept;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (keep[i]) kept.push_back(path[i]);
  return kept;
}

bool Within(const Vector3& p, const std::vector<Vector3>& path, double radius_m) {
  const double reach = radius_m * radius_m;
  if (path.size() == 1) return (p - path[0]).squaredNorm() < reach;
  // from the end: the deepest part of a cut comes late
  for (std::size_t i = path.size() - 1; i > 0; --i)
    if ((p - ClosestOnSegment(p, path[i - 1], path[i])).squaredNorm() < reach) return true;
  return false;
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
  for (std::size_t i = 0; i + 3 < state.balls.size(); i += 4)
    if (state.balls[i + 3] > 0.0f)
      balls.push_back({.center_m = 1e-3 * Vector3(state.balls[i], state.balls[i + 1], state.balls[i + 2]),
                       .radius_m = 1e-3 * state.balls[i + 3]});
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
  std::vector<std::pair<std::vector<Vector3>, double>> sweeps;  // path, radius
  Eigen::AlignedBox3d box;
  for (const ToolBall& ball : tool.balls) {
    if (!ball.cutting || X_GP.empty()) continue;
    std::vector<Vector3> path;
    for (const Pose& X : X_GP) path.push_back(X * Vector3(ball.center_m));
    for (const Vector3& p : path)
      box.extend(p - Vector3::Constant(ball.radius_m)).extend(p + Vector3::Constant(ball.radius_m));
    sweeps.emplace_back(Simplified(path), ball.radius_m);
  }
  if (sweeps.empty()) return 0.0;
  const Eigen::AlignedBox3d cells = box.intersection(solid.Bounds());
  if (cells.isEmpty()) return 0.0;
  const Eigen::Vector3i count = (cells.sizes() / cell_m).array().ceil().cast<int>();
  const Vector3 step = cells.sizes().array() / count.cast<double>().array().max(1.0);
  std::int64_t inside = 0;
  for (int i = 0; i < count.x(); ++i)
    for (int j = 0; j < count.y(); ++j)
      for (int k = 0; k < count.z(); ++k) {
        const Vector3 p = cells.min() + step.cwiseProduct(Vector3(i + 0.5, j + 0.5, k + 0.5));
        const bool swept = std::any_of(sweeps.begin(), sweeps.end(), [&](const auto& sweep) {
          return Within(p, sweep.first, sweep.second);
        });
        if (swept && solid.SignedDistance(p) < 0.0) ++inside;
      }
  return static_cast<double>(inside) * step.prod();
}

}  // namespace osteon::simulation
