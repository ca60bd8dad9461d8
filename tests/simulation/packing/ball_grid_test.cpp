#include "simulation/packing/ball_grid.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

// Tests of the grid index that finds balls near a point.

namespace osteon::simulation {
namespace {

/// Balls of radii from 0.05 mm to 20 mm, log-uniform, anywhere in a cube of 200 mm; they may overlap.
std::vector<Ball> MixedBalls(int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> at(-0.1, 0.1), log_radius(std::log(0.05e-3), std::log(20e-3));
  std::vector<Ball> balls(count);
  for (Ball& ball : balls)
    ball = {.center_m = Vector3(at(random), at(random), at(random)),
            .radius_m = std::exp(log_radius(random))};
  return balls;
}

/// Distance from p to the ball's surface, negative inside.
double Gap(const Ball& ball, const Vector3& p) { return (p - Vector3(ball.center_m)).norm() - ball.radius_m; }

TEST(BallGrid, FindsTheSameBallsAndClearanceAsALoopOverAllBalls) {
  std::mt19937_64 random(1);
  for (const int count : {0, 1, 30, 5000}) {
    const std::vector<Ball> balls = MixedBalls(count, random);
    // the origin of the grid's cells is far from the balls, as for a mesh in a scanner's frame
    BallGrid grid(Vector3(0.05, -0.3, 0.9));
    for (const Ball& ball : balls) grid.Insert(ball);
    std::uniform_real_distribution<double> at(-0.12, 0.12);
    for (int i = 0; i < 200; ++i) {
      const Vector3 p(at(random), at(random), at(random));
      const double reach = i % 4 == 0 ? 0.03 : 0.002;
      std::vector<double> expected, gaps;
      double clearance = reach;
      for (const Ball& ball : balls) {
        if (Gap(ball, p) < reach) expected.push_back(Gap(ball, p));
        clearance = std::min(clearance, Gap(ball, p));
      }
      std::vector<Ball> found;
      grid.Gather(p, reach, found);
      for (const Ball& ball : found) gaps.push_back(Gap(ball, p));
      std::sort(expected.begin(), expected.end());
      std::sort(gaps.begin(), gaps.end());
      ASSERT_EQ(gaps, expected);
      ASSERT_NEAR(grid.Clearance(p, reach), clearance, 1e-16);  // the squares are summed in another order
    }
  }
}

}  // namespace
}  // namespace osteon::simulation
