#include "simulation/contact/constrained_goal.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace osteon::simulation {
namespace {

constexpr int kSets = 300;

/// Planes whose normals lie within a cone about +z and that pass near a point at z = 5 mm: they have points
/// in common.
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

double SumOfMultipliers(const ConstrainedGoal& hold) {
  double sum = 0.0;
  for (int k = 0; k < hold.count; ++k) sum += hold.multiplier_m[static_cast<std::size_t>(k)];
  return sum;
}

TEST(FindConstrainedGoal, OfNoPlaneIsTheOrigin) {
  const ConstrainedGoal hold = FindConstrainedGoal({});
  EXPECT_EQ(hold.point_m, Vector3::Zero());
  EXPECT_EQ(hold.count, 0);
  EXPECT_EQ(FindConstrainedGoal(std::vector<HalfSpace>{{.n = Vector3::UnitZ(), .offset = -1e-3}}).count, 0);
}

// Oracle: the servo loop's projection, which tries every set of up to three planes.
TEST(FindConstrainedGoal, OfUpToEightPlanesIsTheServoLoopsPoint) {
  std::mt19937 random(1);
  for (int i = 0; i < kSets; ++i) {
    const int count = 1 + i % kMaxHalfSpaces;
    const std::vector<HalfSpace> planes = RandomPlanes(random, count);
    std::array<HalfSpace, kMaxHalfSpaces> some{};
    std::copy(planes.begin(), planes.end(), some.begin());
    const HalfSpaceProjection expected = ClosestInHalfSpaces(some, count);
    if (expected.violation > 0.0) continue;  // it gave up on planes that are nearly parallel
    const ConstrainedGoal hold = FindConstrainedGoal(planes);
    // all planes yield by the slack, which moves the point by the slack over the sine of the angle between
    // two of them
    double multipliers = 0.0;
    for (const double m : expected.multiplier) multipliers += m;
    EXPECT_LT((hold.point_m - expected.point).norm(), 100.0 * kHoldSlack * (multipliers + 1e-3)) << i;
  }
}

// Optimality conditions: the point satisfies all planes, lies on those that hold, and is a combination of
// their normals.
TEST(FindConstrainedGoal, OfSixtyPlanesKeepsThemAllAndIsMadeOfThoseThatHold) {
  std::mt19937 random(2);
  for (int i = 0; i < kSets; ++i) {
    const std::vector<HalfSpace> planes = RandomPlanes(random, 60);
    const ConstrainedGoal hold = FindConstrainedGoal(planes);
    ASSERT_GE(hold.count, 1);
    ASSERT_LE(hold.count, 4);
    EXPECT_NEAR(hold.slack_m, kHoldSlack * SumOfMultipliers(hold), 1e-15);
    for (const HalfSpace& plane : planes)
      ASSERT_GE(plane.n.dot(hold.point_m) + hold.slack_m - plane.offset, -1e-11) << i;
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < hold.count; ++k) {
      const auto j = static_cast<std::size_t>(k);
      const HalfSpace& plane = planes[hold.plane[j]];
      EXPECT_GT(hold.multiplier_m[j], 0.0);
      EXPECT_NEAR(plane.n.dot(hold.point_m) + hold.slack_m, plane.offset, 1e-9) << i;
      sum += hold.multiplier_m[j] * plane.n;
    }
    EXPECT_LT((sum - hold.point_m).norm(), 1e-12);
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

TEST(FindConstrainedGoal, BetweenWallsThatLeaveNoRoomIsTheMiddle) {
  const std::vector<HalfSpace> planes{{.n = Vector3::UnitX(), .offset = 1e-3},
                                      {.n = -Vector3::UnitX(), .offset = -0.8e-3},
                                      {.n = Vector3::UnitZ(), .offset = 2e-3}};
  const ConstrainedGoal hold = FindConstrainedGoal(planes);
  EXPECT_NEAR(hold.point_m.x(), 0.9e-3, 1e-8);
  EXPECT_NEAR(hold.point_m.z(), 2e-3 - 0.1e-3, 1e-8);  // yields like the walls
  EXPECT_NEAR(hold.slack_m, 0.1e-3, 1e-8);
}

}  // namespace
}  // namespace osteon::simulation
