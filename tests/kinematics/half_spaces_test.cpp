#include "kinematics/half_spaces.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon {
namespace {

using Planes = std::array<HalfSpace, kMaxHalfSpaces>;

class HalfSpacesTest : public ::testing::Test {
 protected:
  Vector3 RandomUnit() { return Vector3(normal_(random_), normal_(random_), normal_(random_)).normalized(); }

  // Planes that all contain `inside`, some tightly: the intersection is never empty.
  Planes PlanesContaining(const Vector3& inside, int count) {
    Planes planes;
    for (int i = 0; i < count; ++i) {
      HalfSpace& plane = planes[static_cast<std::size_t>(i)];
      plane.n = RandomUnit();
      plane.offset = plane.n.dot(inside) - std::max(0.0, normal_(random_)) * 1e-3;
    }
    return planes;
  }

  std::mt19937_64 random_{7};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

// Largest distance of x outside a plane [m]; negative if x is inside all of them.
double LargestViolation(const Planes& planes, int count, const Vector3& x) {
  double worst = -1e300;
  for (int i = 0; i < count; ++i) {
    const HalfSpace& plane = planes[static_cast<std::size_t>(i)];
    worst = std::max(worst, plane.offset - plane.n.dot(x));
  }
  return worst;
}

// Dykstra's alternating projections, an unrelated algorithm, converge to the intersection's nearest point.
Vector3 Dykstra(const Planes& planes, int count, int sweeps) {
  Vector3 x = Vector3::Zero();
  std::array<Vector3, kMaxHalfSpaces> correction;
  correction.fill(Vector3::Zero());
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const Vector3 y = x + correction[i];
      x = y + std::max(0.0, planes[i].offset - planes[i].n.dot(y)) * planes[i].n;
      correction[i] = y - x;
    }
  return x;
}

// Necessary and sufficient conditions for the nearest point; 1e-9 is the solver's own tolerance [m].
void ExpectOptimal(const Planes& planes, int count, const HalfSpaceProjection& result) {
  EXPECT_EQ(result.violation, 0.0);
  EXPECT_LE(LargestViolation(planes, count, result.point), 1e-9);
  Vector3 sum = Vector3::Zero();
  int active = 0;
  for (int i = 0; i < kMaxHalfSpaces; ++i) {
    const double multiplier = result.multiplier[static_cast<std::size_t>(i)];
    const HalfSpace& plane = planes[static_cast<std::size_t>(i)];
    EXPECT_GE(multiplier, 0.0);
    if (multiplier == 0.0) continue;
    ASSERT_LT(i, count);
    ++active;
    sum += multiplier * plane.n;
    EXPECT_NEAR(plane.n.dot(result.point), plane.offset, 1e-9) << "a plane that pushes is touched";
  }
  EXPECT_LE(active, 3);
  EXPECT_LT((sum - result.point).norm(), 1e-12 + 1e-9 * result.point.norm());
}

TEST_F(HalfSpacesTest, ResultMeetsTheConditionsOfOptimality) {
  int pushed = 0;
  for (int n = 0; n < 20'000; ++n) {
    const int count = n % (kMaxHalfSpaces + 1);
    const Planes planes = PlanesContaining(RandomUnit() * 2e-3, count);
    const HalfSpaceProjection result = ClosestInHalfSpaces(planes, count);
    ExpectOptimal(planes, count, result);
    if (HasFatalFailure()) FAIL() << "set " << n;
    if (result.point.norm() > 0.0) ++pushed;
  }
  EXPECT_GT(pushed, 10'000);
}

// Dykstra's method is slow if planes meet at a flat angle. The test compares only the cases in which it
// converges within 2000 sweeps; at least 200 of 300 must.
TEST_F(HalfSpacesTest, AlternatingProjectionsFindTheSamePoint) {
  int converged = 0;
  for (int n = 0; n < 300; ++n) {
    const Planes planes = PlanesContaining(RandomUnit() * 2e-3, kMaxHalfSpaces);
    const Vector3 x = ClosestInHalfSpaces(planes, kMaxHalfSpaces).point,
                  y = Dykstra(planes, kMaxHalfSpaces, 2000);
    if (LargestViolation(planes, kMaxHalfSpaces, y) > 1e-12) continue;
    ++converged;
    EXPECT_LT((x - y).norm(), 1e-8) << "set " << n;
  }
  EXPECT_GT(converged, 200);
}

TEST_F(HalfSpacesTest, TheOriginStaysIfNoPlaneExcludesIt) {
  Planes planes;
  EXPECT_EQ(ClosestInHalfSpaces(planes, 0).point, Vector3::Zero());
  planes[0] = {Vector3::UnitX(), -1e-3};
  planes[1] = {Vector3::UnitZ(), 0.0};
  EXPECT_EQ(ClosestInHalfSpaces(planes, 2).point, Vector3::Zero());
}

TEST_F(HalfSpacesTest, CornerIsFoundExactly) {
  Planes planes;
  planes[0] = {Vector3::UnitX(), 1e-3};
  planes[1] = {Vector3::UnitY(), 2e-3};
  planes[2] = {Vector3::UnitZ(), 3e-3};
  const HalfSpaceProjection result = ClosestInHalfSpaces(planes, 3);
  EXPECT_LT((result.point - Vector3(1e-3, 2e-3, 3e-3)).norm(), 1e-15);
  EXPECT_NEAR(result.multiplier[2], 3e-3, 1e-15);
}

// Parallel planes, one of which lies 0.5 mm further out. This plane has each index in turn, and alone
// determines the result.
TEST_F(HalfSpacesTest, ParallelPlanesActAsTheForemost) {
  for (int foremost = 0; foremost < kMaxHalfSpaces; ++foremost) {
    Planes planes;
    const Vector3 n = RandomUnit();
    for (HalfSpace& plane : planes) plane = {n, 1e-3};
    planes[static_cast<std::size_t>(foremost)].offset = 1.5e-3;
    const HalfSpaceProjection result = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
    EXPECT_LT((result.point - 1.5e-3 * n).norm(), 1e-15);
    EXPECT_EQ(result.violation, 0.0);
  }
}

// The planes require x >= 3 mm and x <= 1 mm. The point must be in the middle, 1 mm outside each of them, and
// must still satisfy the plane of y.
TEST_F(HalfSpacesTest, OppositeWallsThatOverlapCentreThePoint) {
  Planes planes;
  planes[0] = {Vector3::UnitX(), 3e-3};
  planes[1] = {-Vector3::UnitX(), -1e-3};
  const HalfSpaceProjection two = ClosestInHalfSpaces(planes, 2);
  EXPECT_LT((two.point - Vector3(2e-3, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(two.violation, 1e-3, 1e-12);
  planes[2] = {Vector3::UnitY(), 5e-3};
  const HalfSpaceProjection three = ClosestInHalfSpaces(planes, 3);
  EXPECT_LT((three.point - Vector3(2e-3, 4e-3, 0)).norm(), 1e-8)
      << "the slack is common: y may lag by 1 mm too";
}

// Random empty sets: no point of a dense search around the result has a smaller violation. The solver accepts
// 1e-6 more violation for a nearer point, hence the margin.
TEST_F(HalfSpacesTest, EmptySetGivesTheLeastViolation) {
  int empty = 0;
  for (int n = 0; n < 300; ++n) {
    Planes planes;
    for (HalfSpace& plane : planes) plane = {RandomUnit(), 1e-3 * (1.0 + std::abs(normal_(random_)))};
    const HalfSpaceProjection result = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
    ASSERT_TRUE(result.point.allFinite());
    if (result.violation == 0.0) continue;
    ++empty;
    EXPECT_NEAR(LargestViolation(planes, kMaxHalfSpaces, result.point), result.violation, 1e-15);
    for (int trial = 0; trial < 2000; ++trial) {
      const double radius = std::pow(10.0, -6.0 + 4.5 * (trial % 100) / 100.0);
      const Vector3 other = result.point + radius * RandomUnit();
      EXPECT_GT(LargestViolation(planes, kMaxHalfSpaces, other), result.violation * (1.0 - 1e-3))
          << "set " << n;
    }
  }
  EXPECT_GT(empty, 50);
}

// Almost parallel, almost opposite, zero and tiny offsets: every result is finite and reports its violation.
TEST_F(HalfSpacesTest, DegenerateSetsStayFinite) {
  for (int n = 0; n < 5'000; ++n) {
    Planes planes;
    const Vector3 base = RandomUnit();
    const double spread = std::pow(10.0, -16.0 + (n % 16));
    for (HalfSpace& plane : planes) {
      const double side = normal_(random_) > 0.0 ? 1.0 : -1.0;
      plane = {(side * base + spread * RandomUnit()).normalized(), normal_(random_) * 1e-3};
    }
    const HalfSpaceProjection result = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
    ASSERT_TRUE(result.point.allFinite());
    ASSERT_TRUE(std::isfinite(result.violation));
    const double worst = std::max(0.0, LargestViolation(planes, kMaxHalfSpaces, result.point));
    EXPECT_NEAR(result.violation, worst, 1.1e-9) << "spread " << spread;
  }
}

TEST_F(HalfSpacesTest, EqualInputsGiveEqualBits) {
  const Planes planes = PlanesContaining(RandomUnit() * 2e-3, kMaxHalfSpaces);
  const HalfSpaceProjection a = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
  const HalfSpaceProjection b = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.multiplier, b.multiplier);
}

TEST_F(HalfSpacesTest, DoesNotAllocate) {
  Planes planes = PlanesContaining(RandomUnit() * 2e-3, kMaxHalfSpaces);
  Planes empty = planes;
  empty[0] = {Vector3::UnitX(), 3e-3};
  empty[1] = {-Vector3::UnitX(), -1e-3};
  rt::CheckedNoAllocScope no_alloc;
  const HalfSpaceProjection a = ClosestInHalfSpaces(planes, kMaxHalfSpaces);
  const HalfSpaceProjection b = ClosestInHalfSpaces(empty, kMaxHalfSpaces);
  no_alloc.End();
  EXPECT_TRUE(a.point.allFinite() && b.violation > 0.0);
}

}  // namespace
}  // namespace osteon
