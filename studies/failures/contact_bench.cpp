#include "studies/failures/contact_bench.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteon::studies {

void Append(const simulation::Bone& from, simulation::Bone& to) {
  to.balls.insert(to.balls.end(), from.balls.begin(), from.balls.end());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
}

simulation::Bone WithFriction(simulation::Bone bone, double friction) {
  for (simulation::Material& material : bone.materials) material.friction = friction;
  return bone;
}

Pose Down(const Vector3& p_m, const Vector3& turn) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(turn) * Eigen::Vector3d(1, -1, -1).asDiagonal();
  X.translation() = p_m;
  return X;
}

double AngleDeg(const Vector3& a, const Vector3& b) {
  if (a.squaredNorm() == 0.0 || b.squaredNorm() == 0.0) return 180.0;
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
}

double DeepestOverlap(const std::vector<simulation::Ball>& balls, const simulation::Tool& tool,
                      const Pose& X_GT) {
  double deepest = 0.0;
  for (const simulation::ToolBall& part : tool.balls) {
    const Vector3 center = X_GT * Vector3(part.center_m);
    for (const simulation::Ball& ball : balls)
      if (ball.radius_m > 0.0)
        deepest = std::max(deepest, part.radius_m + ball.radius_m - (center - Vector3(ball.center_m)).norm());
  }
  return deepest;
}

double Largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

double LargestStep(const std::vector<double>& values) {
  double largest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i)
    largest = std::max(largest, std::abs(values[i] - values[i - 1]));
  return largest;
}

}  // namespace osteon::studies
