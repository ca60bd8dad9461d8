#include "simulation/packing/clearance_climb.h"

#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include "simulation/packing/hole_search.h"
#include "tests/simulation/solids/simple_solids.h"

// Tests of the search for the largest free ball near a point: ridge walks, climbs of the clearance, hole
// search and the grid of distances.

namespace osteon::simulation {
namespace {

Vector3 RandomUnit(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Vector3(normal(random), normal(random), normal(random)).normalized();
}

// A ridge walk maximizes the smallest of several linear bounds, which is a linear programme in the step and
// the clearance. Oracle: any four bounds that are active together give a candidate. The best candidate that
// satisfies all bounds is the optimum.
TEST(RidgeWalk, ReachesTheOptimumOfTheLinearProgramme) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> value(0.0, 1.0);
  int inner = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<ClearanceBound> bounds(4 + trial % 9);
    for (ClearanceBound& bound : bounds) bound = {value(random), RandomUnit(random)};
    const int n = static_cast<int>(bounds.size());
    double best = -1e9;
    for (int a = 0; a < n; ++a)
      for (int b = a + 1; b < n; ++b)
        for (int c = b + 1; c < n; ++c)
          for (int d = c + 1; d < n; ++d) {
            Eigen::Matrix4d rows;
            Eigen::Vector4d values;
            int row = 0;
            for (const int k : {a, b, c, d}) {
              rows.row(row) << -bounds[k].gradient.transpose(), 1.0;
              values[row++] = bounds[k].value_m;
            }
            const Eigen::Vector4d x = rows.fullPivLu().solve(values);
            bool allowed = (rows * x - values).norm() < 1e-9;
            for (const ClearanceBound& bound : bounds)
              allowed &= x[3] <= bound.value_m + bound.gradient.dot(x.head<3>()) + 1e-9;
            if (allowed) best = std::max(best, x[3]);
          }
    const RidgeWalk walk = WalkRidges(bounds, 1e3);
    double reached = 1e9;
    for (const ClearanceBound& bound : bounds)
      reached = std::min(reached, bound.value_m + bound.gradient.dot(walk.step_m));
    EXPECT_NEAR(reached, walk.clearance_m, 1e-9 * (1.0 + std::abs(reached)));
    if (walk.step_m.norm() > 999.0) continue;  // unbounded: the gradients' hull does not contain the origin
    ++inner;
    EXPECT_NEAR(walk.clearance_m, best, 1e-9 * (1.0 + std::abs(best)));
    EXPECT_LE(WalkRidges(bounds, 0.1).step_m.norm(), 0.1 * (1.0 + 1e-12));
  }
  EXPECT_GT(inner, 200);
}

/// A cube of 100 mm about the origin, to which tests add balls.
class InABox : public testing::Test {
 protected:
  /// The largest ball that a climb from p finds.
  Ball ClimbFrom(const Vector3& p, const RadiusCap& cap) {
    const DistanceGrid depths(solid_, 32, 1);
    ClearanceClimb climb(solid_, depths, balls_, cap);
    return climb.Climb(p, 2e-3, 0.1e-3);
  }
  BoxSolid solid_ = CenteredBox(Vector3(0.1, 0.1, 0.1));
  EverywhereZone zone_;
  BallGrid balls_{Vector3::Zero()};
};

// Soddy: four unit balls that touch each other leave room for a ball of radius sqrt(3/2) - 1.
TEST_F(InABox, TheHoleBetweenFourTouchingBallsHasSoddysRadius) {
  const double r = 10e-3;
  for (const Vector3& u : {Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1)})
    balls_.Insert({.center_m = u * (r / std::sqrt(2.0)), .radius_m = r});
  const Ball hole = ClimbFrom({0.4e-3, -0.7e-3, 0.5e-3}, {.zone = zone_, .radius_m = 1.0});
  EXPECT_NEAR(hole.radius_m, (std::sqrt(1.5) - 1.0) * r, 1e-6 * r);  // tolerance at which climbs end
  EXPECT_LT(Vector3(hole.center_m).norm(), 1e-6 * r);
}

TEST_F(InABox, TheHoleInACornerTouchesThreeFacesAndTheBall) {
  balls_.Insert({.center_m = Vector3::Zero(), .radius_m = 0.05});
  const Ball hole = ClimbFrom({0.044, 0.046, 0.042}, {.zone = zone_, .radius_m = 1.0});
  EXPECT_NEAR(hole.radius_m, (2.0 - std::sqrt(3.0)) * 0.05, 1e-6 * 0.05);
}

// If the cap on the radius is smaller than the hole, the ball comes to rest in the hollow above three balls.
TEST_F(InABox, ABallOfLimitedRadiusRestsOnThreeBalls) {
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * std::numbers::pi / 3.0 * i;
    balls_.Insert(
        {.center_m = Vector3(6e-3 * std::cos(angle), 6e-3 * std::sin(angle), 0.0), .radius_m = 5e-3});
  }
  const double cap = 3e-3;
  const Ball hole = ClimbFrom({0.5e-3, -1e-3, 8e-3}, {.zone = zone_, .radius_m = cap});
  EXPECT_NEAR(hole.radius_m, cap, 1e-9 * cap);  // tolerance at which Newton's method ends
  EXPECT_NEAR((Vector3(hole.center_m) - Vector3(0, 0, std::sqrt(64e-6 - 36e-6))).norm(), 0.0, 1e-8 * cap);
}

// A ball fills the box's middle and leaves one hole in each of the eight corners.
TEST_F(InABox, ASearchOfTheWholeBoxFindsExactlyItsEightHoles) {
  balls_.Insert({.center_m = Vector3::Zero(), .radius_m = 0.05});
  const double hole = (2.0 - std::sqrt(3.0)) * 0.05;
  const RadiusCap cap{.zone = zone_, .radius_m = 1.0};
  const DistanceGrid depths(solid_, 32, 1);
  HoleSearch search(solid_, depths, balls_, cap, 0);
  std::vector<Ball> found;
  search.InCube(Vector3::Zero(), 0.1, 0.99 * hole, found);
  ASSERT_EQ(found.size(), 8u);
  for (const Ball& ball : found) EXPECT_NEAR(ball.radius_m, hole, 0.01 * hole);
  found.clear();
  search.InCube(Vector3::Zero(), 0.1, 1.001 * hole, found);
  EXPECT_TRUE(found.empty());
}

// The search climbs from a fixed set of directions around the ball, rotated at random by the seed. A hole
// midway between directions is missed: 216 of the 8000 holes of these seeds. With one direction left out it
// would be 267, so the limit of 240 detects that.
TEST_F(InABox, ASearchAroundABallMissesAtMostThreePercentOfItsHoles) {
  balls_.Insert({.center_m = Vector3::Zero(), .radius_m = 0.05});
  const double hole = (2.0 - std::sqrt(3.0)) * 0.05;
  const RadiusCap cap{.zone = zone_, .radius_m = 1.0};
  const DistanceGrid depths(solid_, 32, 1);
  int missed = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    HoleSearch search(solid_, depths, balls_, cap, seed);
    std::vector<Ball> found;
    search.AroundBall(0, 0.99 * hole, 2.0 * hole, found);
    missed += 8 - static_cast<int>(found.size());
  }
  EXPECT_LE(missed, 240);
}

TEST(DistanceGrid, LowerBoundNeverExceedsTheDistance) {
  const BoxSolid solid = CenteredBox(Vector3(0.1, 0.03, 0.006));
  const DistanceGrid depths(solid, 48, 2);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> at(-0.06, 0.06);
  double nearest = 1.0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3 p = Vector3(at(random), 0.4 * at(random), 0.1 * at(random));
    const double slack = -solid.SignedDistance(p) - depths.LowerBound(p);
    ASSERT_GE(slack, 0.0);
    if (solid.SignedDistance(p) < 0.0) nearest = std::min(nearest, slack);
  }
  EXPECT_LT(nearest, 0.1e-3);  // the lower bound is not simply very low
}

}  // namespace
}  // namespace osteon::simulation
