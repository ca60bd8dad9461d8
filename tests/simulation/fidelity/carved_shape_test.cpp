#include "simulation/fidelity/carved_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

// Tests of the distance to a union of balls.

namespace osteon::simulation {
namespace {

// Oracle: the minimum over all balls. Radii extend over two decades; each seventh ball is removed (radius 0).
TEST(BallUnion, DistanceIsThatToTheNearestBall) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] {
    return Vector3(0.02 * uniform(random), 0.02 * uniform(random), 0.02 * uniform(random));
  };
  std::vector<Ball> balls;
  for (int i = 0; i < 700; ++i)
    balls.push_back(
        {.center_m = point(), .radius_m = i % 7 == 0 ? 0.0 : 1e-3 * std::pow(10.0, uniform(random))});
  const BallUnion shape(balls);
  int inside = 0, near = 0, far = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 p = 1.5 * point();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Ball& ball : balls)
      if (ball.radius_m > 0.0)
        nearest = std::min(nearest, std::max(0.0, (p - Vector3(ball.center_m)).norm() - ball.radius_m));
    // both subtract the same numbers, so they differ by at most one rounding
    ASSERT_NEAR(shape.Distance(p, 1.0), nearest, 1e-17) << i;
    ASSERT_NEAR(shape.Distance(p, 2e-3), std::min(nearest, 2e-3), 1e-17) << i;
    ++(nearest == 0.0 ? inside : nearest < 2e-3 ? near : far);
  }
  EXPECT_GT(std::min({inside, near, far}), 100);
}

TEST(BallUnion, WithoutBallsTheDistanceIsTheGivenMaximum) {
  EXPECT_EQ(BallUnion({}).Distance({1, 2, 3}, 0.5), 0.5);
  const std::vector<Ball> gone{{.center_m = Vector3(0, 0, 0), .radius_m = 0.0}};
  EXPECT_EQ(BallUnion(gone).Distance({0, 0, 0}, 0.25), 0.25);
}

}  // namespace
}  // namespace osteon::simulation
