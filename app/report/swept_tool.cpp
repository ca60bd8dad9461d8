#include "app/report/swept_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace osteon::app {
namespace {

Vector3 NearestOnSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 m = b - a;
  const double length2 = m.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p - a).dot(m) / length2, 0.0, 1.0) : 0.0;
  return a + s * m;
}

/// Douglas and Peucker's thinning, with an explicit stack: a path may have 100 k points.
std::vector<Vector3> Thin(const std::vector<Vector3>& path, double tolerance_m) {
  if (path.size() < 3) return path;
  std::vector<char> keep(path.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, path.size() - 1}};
  while (!stack.empty()) {
    const auto [first, last] = stack.back();
    stack.pop_back();
    double worst = tolerance_m;
    std::size_t at = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = (path[i] - NearestOnSegment(path[i], path[first], path[last])).norm();
      if (distance > worst) {
        worst = distance;
        at = i;
      }
    }
    if (at == 0) continue;
    keep[at] = 1;
    stack.emplace_back(first, at);
    stack.emplace_back(at, last);
  }
  std::vector<Vector3> thin;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (keep[i]) thin.push_back(path[i]);
  return thin;
}

}  // namespace

SweptTool::SweptTool(const simulation::Tool& tool, std::span<const Pose> X_GP, double tolerance_m) {
  constexpr std::size_t kChunk = 16;
  for (const simulation::ToolBall& ball : tool.balls) {
    if (!ball.cutting || !(ball.radius_m > 0.0)) continue;
    std::vector<Vector3> path;
    for (const Pose& X : X_GP) {
      const Vector3 c = X * Vector3(ball.center_m);
      if (c.allFinite()) path.push_back(c);
    }
    path = Thin(path, tolerance_m);
    if (path.size() == 1) path.push_back(path.front());
    for (std::size_t i = 0; i + 1 < path.size(); i += kChunk) {
      const std::size_t end = std::min(i + kChunk, path.size() - 1);
      Chunk chunk{path[i], path[i], capsules_.size(), capsules_.size() + end - i, ball.radius_m};
      for (std::size_t k = i; k < end; ++k) {
        capsules_.push_back({path[k], path[k + 1], ball.radius_m});
        chunk.min = chunk.min.cwiseMin(path[k + 1]);
        chunk.max = chunk.max.cwiseMax(path[k + 1]);
      }
      chunks_.push_back(chunk);
    }
  }
}

SweptDistance SweptTool::Nearest(const Vector3& p_G) const {
  SweptDistance best{std::numeric_limits<double>::infinity(), p_G};
  for (const Chunk& chunk : chunks_) {
    const double to_box = (chunk.min - p_G).cwiseMax(p_G - chunk.max).cwiseMax(0.0).norm();
    if (to_box - chunk.radius_m >= best.distance_m) continue;
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
      const Vector3 axis_G = NearestOnSegment(p_G, capsules_[i].a, capsules_[i].b);
      const double distance_m = (p_G - axis_G).norm() - capsules_[i].radius_m;
      if (distance_m < best.distance_m) best = {distance_m, axis_G};
    }
  }
  return best;
}

std::vector<Pose> ProxyPath(std::span<const simulation::FrameRecord> frames, const Pose& X_WG) {
  const Pose X_GW = X_WG.inverse();
  std::vector<Pose> path;
  for (const simulation::FrameRecord& frame : frames) {
    if (frame.model.frame == 0 || frame.model.status != simulation::EngineStatus::kOk) continue;
    const Pose X_GP = X_GW * Pose(frame.model.X_WP);
    if (X_GP.matrix().allFinite()) path.push_back(X_GP);
  }
  return path;
}

const simulation::ToolBall* CuttingHead(const simulation::Tool& tool) {
  const simulation::ToolBall* head = nullptr;
  for (const simulation::ToolBall& ball : tool.balls)
    if (ball.cutting && (head == nullptr || ball.radius_m > head->radius_m)) head = &ball;
  return head;
}

}  // namespace osteon::app
