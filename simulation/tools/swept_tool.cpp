#include "simulation/tools/swept_tool.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/contact/cutting_math.h"
#include "simulation/tools/thin_path.h"

namespace osteon::simulation {

SweptTool::SweptTool(const Tool& tool, std::span<const Pose> X_GP, double tolerance_m) {
  Add({.tool = &tool, .X_GP = X_GP}, tolerance_m);
}

SweptTool::SweptTool(std::span<const ToolPath> paths, double tolerance_m) {
  for (const ToolPath& path : paths) Add(path, tolerance_m);
}

void SweptTool::Add(const ToolPath& tool_path, double tolerance_m) {
  constexpr std::size_t kChunk = 16;  // largest number of capsules in a chunk
  for (const ToolBall& ball : tool_path.tool->balls) {
    if (!ball.cutting || !(ball.radius_m > 0.0)) continue;
    std::vector<Vector3> path;
    for (const Pose& X : tool_path.X_GP) {
      const Vector3 c = X * Vector3(ball.center_m);
      if (c.allFinite()) path.push_back(c);
    }
    path = ThinPath(path, tolerance_m, [](const Vector3& p, const Vector3& a, const Vector3& b) {
      return (p - ClosestOnSegment(p, a, b)).norm();
    });
    if (path.size() == 1) path.push_back(path.front());  // a tool that did not move sweeps its own balls
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
    // Every capsule of the chunk is at least as far away as the chunk's box, less the ball's radius.
    const double to_box = (chunk.min - p_G).cwiseMax(p_G - chunk.max).cwiseMax(0.0).norm();
    if (to_box - chunk.radius_m >= best.distance_m) continue;
    for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
      const Vector3 axis_G = ClosestOnSegment(p_G, capsules_[i].a, capsules_[i].b);
      const double distance_m = (p_G - axis_G).norm() - capsules_[i].radius_m;
      if (distance_m < best.distance_m) best = {distance_m, axis_G};
    }
  }
  return best;
}

Eigen::AlignedBox3d SweptTool::Bounds() const {
  Eigen::AlignedBox3d box;
  for (const Chunk& chunk : chunks_) {
    box.extend(chunk.min - Vector3::Constant(chunk.radius_m));
    box.extend(chunk.max + Vector3::Constant(chunk.radius_m));
  }
  return box;
}

}  // namespace osteon::simulation
