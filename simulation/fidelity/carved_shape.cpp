#include "simulation/fidelity/carved_shape.h"

#include <vector>

namespace osteon::simulation {
namespace {

// The balls with a radius above 0: a ball of radius 0 is gone.
std::vector<Ball> WithRadius(std::span<const Ball> balls) {
  std::vector<Ball> left;
  left.reserve(balls.size());
  for (const Ball& ball : balls)
    if (ball.radius_m > 0.0) left.push_back(ball);
  return left;
}

}  // namespace

BallUnion::BallUnion(std::span<const Ball> balls) : forest_(WithRadius(balls)) {}

double BallUnion::Distance(const Vector3& p_G, double at_most_m) const { return forest_.Gap(p_G, at_most_m); }

}  // namespace osteon::simulation
