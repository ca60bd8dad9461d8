#include "simulation/contact/constrained_goal.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

// Tests of the point nearest to the goal (the origin) that satisfies a set of half-spaces.

namespace osteon::simulation {
namespace {

constexpr int kRandomSets = 300;

/// Half-spaces whose random normals tend towards +z and which all contain the point at z = 5 mm.
std::vector<HalfSpace> RandomPlanes(std::mt19937& random, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> u(0.0, 1.0);
  std::vector<HalfSpace> planes;
  for (int i = 0; i < count; ++i) {
    const Vector3 n = Vector3(normal(random), normal(random), 1.5 + normal(random)).normalized();
    planes.push_back({.n = n, .offset = n.z() * 5e-3 - 2e-3 * u(random)});
  }
  return planes;
}

double SumOfMultipliers(const ConstrainedGoal& goal) {
  double sum = 0.0;
  for (int k = 0; k < goal.count; ++k) sum += goal.multiplier_m[static_cast<std::size_t>(k)];
  return sum;
}

TEST(FindConstrainedGoal, ReturnsTheOriginIfNoPlaneExcludesIt) {
  const ConstrainedGoal goal = FindConstrainedGoal({});
  EXPECT_EQ(goal.point_m, Vector3::Zero());
  EXPECT_EQ(goal.count, 0);
  EXPECT_EQ(FindConstrainedGoal(std::vector<HalfSpace>{{.n = Vector3::UnitZ(), .offset = -1e-3}}).count, 0);
}

// Oracle: the servo loop's projection, which tries every set of up to three planes.
TEST(FindConstrainedGoal, EqualsTheServoLoopsProjectionForUpToEightPlanes) {
  std::mt19937 random(1);
  for (int i = 0; i < kRandomSets; ++i) {
    const int count = 1 + i % kMaxHalfSpaces;
    const std::vector<HalfSpace> planes = RandomPlanes(random, count);
    std::array<HalfSpace, kMaxHalfSpaces> some{};
    std::copy(planes.begin(), planes.end(), some.begin());
    const HalfSpaceProjection expected = ClosestInHalfSpaces(some, count);
    if (expected.violation > 0.0) continue;  // the oracle does not solve planes that are nearly parallel
    const ConstrainedGoal goal = FindConstrainedGoal(planes);
    // FindConstrainedGoal relaxes all planes by kHoldSlack, which moves the point by the slack over the sine
    // of the angle between two planes
    double multipliers = 0.0;
    for (const double m : expected.multiplier) multipliers += m;
    EXPECT_LT((goal.point_m - expected.point).norm(), 100.0 * kHoldSlack * (multipliers + 1e-3)) << i;
  }
}

// Optimality (KKT) conditions: the point satisfies all planes, lies on the holding planes, and is a
// combination of their normals with positive multipliers.
TEST(FindConstrainedGoal, MeetsTheOptimalityConditionsForSixtyPlanes) {
  std::mt19937 random(2);
  for (int i = 0; i < kRandomSets; ++i) {
    const std::vector<HalfSpace> planes = RandomPlanes(random, 60);
    const ConstrainedGoal goal = FindConstrainedGoal(planes);
    ASSERT_GE(goal.count, 1);
    ASSERT_LE(goal.count, 4);
    EXPECT_NEAR(goal.slack_m, kHoldSlack * SumOfMultipliers(goal), 1e-15);
    for (const HalfSpace& plane : planes)
      ASSERT_GE(plane.n.dot(goal.point_m) + goal.slack_m - plane.offset, -1e-11) << i;
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < goal.count; ++k) {
      const auto j = static_cast<std::size_t>(k);
      const HalfSpace& plane = planes[goal.plane[j]];
      EXPECT_GT(goal.multiplier_m[j], 0.0);
      EXPECT_NEAR(plane.n.dot(goal.point_m) + goal.slack_m, plane.offset, 1e-9) << i;
      sum += goal.multiplier_m[j] * plane.n;
    }
    EXPECT_LT((sum - goal.point_m).norm(), 1e-12);
  }
}

TEST(FindConstrainedGoal, DoesNotDependOnTheOrderOfPlanes) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    std::vector<HalfSpace> planes = RandomPlanes(random, 40);
    const Vector3 point = FindConstrainedGoal(planes).point_m;
    std::shuffle(planes.begin(), planes.end(), random);
    EXPECT_LT((FindConstrainedGoal(planes).point_m - point).norm(), 1e-9) << i;
  }
}

// The half-spaces of two opposite walls miss each other by 0.2 mm. Both walls and the floor are relaxed by
// half of this.
TEST(FindConstrainedGoal, LiesInTheMiddleBetweenWallsThatLeaveNoRoom) {
  const std::vector<HalfSpace> planes{{.n = Vector3::UnitX(), .offset = 1e-3},
                                      {.n = -Vector3::UnitX(), .offset = -0.8e-3},
                                      {.n = Vector3::UnitZ(), .offset = 2e-3}};
  const ConstrainedGoal goal = FindConstrainedGoal(planes);
  EXPECT_NEAR(goal.point_m.x(), 0.9e-3, 1e-8);
  EXPECT_NEAR(goal.point_m.z(), 2e-3 - 0.1e-3, 1e-8);
  EXPECT_NEAR(goal.slack_m, 0.1e-3, 1e-8);
}

}  // namespace
}  // namespace osteon::simulation
