#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "base/scramble.h"
#include "simulation/packing/counted_packing.h"
#include "simulation/solids/acetabulum_solid.h"
#include "simulation/solids/ball_solid.h"

// Tests of packings with a given number of balls. They keep the scene's packing in the cut zone, or they are
// uniform.

namespace osteon::simulation {
namespace {

// All numbers of a ball, to sort and compare balls.
auto Key(const Ball& ball) {
  return std::tuple(ball.center_m.x, ball.center_m.y, ball.center_m.z, ball.radius_m);
}

// The balls whose centres are less than depth_m from the zone, sorted.
std::vector<Ball> WithinZone(const std::vector<Ball>& balls, const CutZone& zone, double depth_m) {
  std::vector<Ball> within;
  for (const Ball& ball : balls)
    if (zone.DepthAt(Vector3(ball.center_m)) < depth_m) within.push_back(ball);
  std::sort(within.begin(), within.end(), [](const Ball& a, const Ball& b) { return Key(a) < Key(b); });
  return within;
}

// Expects every ball to lie inside the solid, to a nanometre.
void ExpectInside(const Solid& solid, const std::vector<Ball>& balls) {
  double worst_m = -HUGE_VAL;
  for (const Ball& ball : balls)
    worst_m = std::max(worst_m, solid.SignedDistance(Vector3(ball.center_m)) + ball.radius_m);
  EXPECT_LT(worst_m, 1e-9);
}

// Share of 500 random points of the solid, at least `below_m` under its surface, that no ball contains.
double ShareOutside(const Solid& solid, const std::vector<Ball>& balls, double below_m) {
  std::uint64_t seed = 0;
  int outside = 0, count = 0;
  const Eigen::AlignedBox3d box = solid.Bounds();
  while (count < 500) {
    Vector3 u;
    for (int axis = 0; axis < 3; ++axis) u[axis] = Uniform(Scramble(seed++));
    const Vector3 p = box.min() + box.sizes().cwiseProduct(u);
    if (solid.SignedDistance(p) > -below_m) continue;
    ++count;
    const bool contained = std::any_of(balls.begin(), balls.end(), [&](const Ball& ball) {
      return (p - Vector3(ball.center_m)).squaredNorm() <= ball.radius_m * ball.radius_m;
    });
    outside += contained ? 0 : 1;
  }
  return outside / 500.0;
}

TEST(CountedPacking, KeepsTheCutZonesBallsAndReachesTheCountWithTheRest) {
  const AcetabulumSolid solid({});
  const CupZone zone(solid.cup());
  const PackingParams base;
  const std::vector<Ball> standard = BuildPacking(solid, zone, base);
  const double depth_m = base.lattice.coarser_from_m.front();
  for (const std::size_t count : {60'000u, 200'000u}) {
    const std::vector<Ball> balls = BuildCountedPacking(solid, zone, base, count, CountedGrade::kFixedZone);
    EXPECT_NEAR(static_cast<double>(balls.size()), static_cast<double>(count),
                0.02 * static_cast<double>(count));
    ExpectInside(solid, balls);
    const auto kept = WithinZone(balls, zone, depth_m), asked = WithinZone(standard, zone, depth_m);
    ASSERT_EQ(kept.size(), asked.size());
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), asked.begin(),
                           [](const Ball& a, const Ball& b) { return Key(a) == Key(b); }));
    if (count == 60'000u) {
      EXPECT_EQ(ShareOutside(solid, balls, 2e-3), 0.0);  // the lattice's spacing is 2 mm
    }
  }
}

// The count is smaller than the number of balls in the cut zone, so the zone cannot keep its balls.
TEST(CountedPacking, IsCoarserEverywhereForAVerySmallCount) {
  const AcetabulumSolid solid({});
  const CupZone zone(solid.cup());
  EXPECT_EQ(BuildCountedPacking(solid, zone, {}, 1000, CountedGrade::kFixedZone).size(), 1000u);
}

TEST(CountedPacking, AUniformPackingReachesTheCountAndLeavesNoHoles) {
  const AcetabulumSolid solid({});
  const CupZone zone(solid.cup());
  double last_m = HUGE_VAL;
  for (const std::size_t count : {1000u, 30'000u}) {
    const std::vector<Ball> balls = BuildCountedPacking(solid, zone, {}, count, CountedGrade::kUniform);
    EXPECT_NEAR(static_cast<double>(balls.size()), static_cast<double>(count),
                0.02 * static_cast<double>(count));
    ExpectInside(solid, balls);
    double max_m = 0.0;
    for (const Ball& ball : balls) max_m = std::max(max_m, ball.radius_m);
    EXPECT_LT(max_m, last_m);
    last_m = max_m;
    EXPECT_EQ(ShareOutside(solid, balls, 1.2 * max_m), 0.0) << count;
  }
}

TEST(CountedPacking, DoesNotDependOnThreads) {
  const AcetabulumSolid solid({});
  const CupZone zone(solid.cup());
  PackingParams one;
  one.threads = 1;
  PackingParams three;
  three.threads = 3;
  for (const CountedGrade grade : {CountedGrade::kFixedZone, CountedGrade::kUniform}) {
    const auto a = BuildCountedPacking(solid, zone, one, 40'000, grade),
               b = BuildCountedPacking(solid, zone, three, 40'000, grade);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(),
                           [](const Ball& x, const Ball& y) { return Key(x) == Key(y); }));
  }
}

TEST(CountedPacking, RefusesCountsOutOfRange) {
  const BallSolid solid(0.01);
  EXPECT_THROW((void)BuildCountedPacking(solid, EverywhereZone(), {}, 0, CountedGrade::kUniform),
               std::invalid_argument);
  EXPECT_THROW((void)BuildCountedPacking(solid, EverywhereZone(), {}, 100'000'001, CountedGrade::kUniform),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
