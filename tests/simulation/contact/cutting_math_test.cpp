#include "simulation/contact/cutting_math.h"

#include <random>

#include <gtest/gtest.h>

// Tests of the closed forms of the cutting model: first contact, lens volume and shrinking of balls.

namespace osteon::simulation {
namespace {

// Seeded random numbers and directions.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double In(double low, double high) { return low + (high - low) * uniform_(engine_); }
  Vector3 Direction() { return Vector3(normal_(engine_), normal_(engine_), normal_(engine_)).normalized(); }

 private:
  std::mt19937 engine_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::normal_distribution<double> normal_;
};

// ---- pass 1: first contact

/// Oracle for FirstContactFraction: first s in [0, 1] with |D - s m| = R, by bisection; kNoContact if the
/// balls stay apart.
double BisectToContact(const Vector3& D, const Vector3& m, double R) {
  const auto apart = [&](double s) { return (D - s * m).norm() - R; };
  // the distance is convex in s: its minimum is at the foot of the perpendicular
  const double closest = std::clamp(D.dot(m) / m.squaredNorm(), 0.0, 1.0);
  if (apart(closest) > 0.0) return kNoContact;
  double low = 0.0, high = closest;
  for (int i = 0; i < 100; ++i) (apart(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
  return high;
}

TEST(FirstContact, AgreesWithBisectionForPairsThatAreApart) {
  Random random(1);
  int hits = 0, misses = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double R = random.In(0.1e-3, 30e-3);
    const Vector3 D = (R + random.In(1e-6, 20e-3)) * random.Direction();
    const Vector3 m = random.In(1e-6, 40e-3) * random.Direction();
    const double expected = BisectToContact(D, m, R), s = FirstContactFraction(D, m, R);
    // leave out grazing pairs: the fraction contains the root of a rounded value, accurate only to sqrt(eps)
    const double miss = (D - std::clamp(D.dot(m) / m.squaredNorm(), 0.0, 1.0) * m).norm() - R;
    if (std::abs(miss) < 1e-12) continue;
    ASSERT_EQ(expected == kNoContact, s == kNoContact) << i;
    if (s == kNoContact) {
      ++misses;
      continue;
    }
    ++hits;
    // the place of contact must be exact: the balls touch there, up to the rounding of coordinates of some
    // centimetres
    ASSERT_NEAR((D - s * m).norm(), R, 1e-14) << i;
    ASSERT_NEAR((s - expected) * m.norm(), 0.0, 1e-8) << i;
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 1000);
}

TEST(FirstContact, IsNoneBeyondTheEndOfThePath) {
  const Vector3 D(0, 0, -10e-3);
  const double R = 4e-3;  // 6 mm to go
  EXPECT_DOUBLE_EQ(FirstContactFraction(D, {0, 0, -12e-3}, R), 0.5);
  EXPECT_NEAR(FirstContactFraction(D, {0, 0, -6e-3 * (1 + 1e-12)}, R), 1.0, 1e-11);
  EXPECT_EQ(FirstContactFraction(D, {0, 0, -5.999e-3}, R), kNoContact);
}

TEST(FirstContact, OverlappingBallsTouchAtOnceInwardsAndNeverOutwards) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const double R = random.In(1e-3, 30e-3);
    const Vector3 D = random.In(1e-9, 1.0) * R * random.Direction();
    const Vector3 m = random.In(1e-6, 5e-3) * random.Direction();
    ASSERT_EQ(FirstContactFraction(D, m, R), D.dot(m) > 0.0 ? 0.0 : kNoContact);
  }
}

TEST(FirstContact, IsNoneWithoutMotionWhetherTheBallsOverlapOrNot) {
  EXPECT_EQ(FirstContactFraction({0, 0, 5e-3}, Vector3::Zero(), 1e-3), kNoContact);
  EXPECT_EQ(FirstContactFraction({0, 0, 5e-3}, Vector3::Zero(), 9e-3), kNoContact);
  EXPECT_EQ(FirstContactFraction(Vector3::Zero(), Vector3::Zero(), 9e-3), kNoContact);
}

TEST(FirstContact, GrazingBallsTouchJustBeforeTheirClosestApproach) {
  // a ball that passes the centre at a distance p makes contact sqrt(R^2 - p^2) before the closest approach;
  // no contact if p > R
  const double R = 10e-3, way = 20e-3;
  for (const double inside : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double p = R - inside;
    const double s = FirstContactFraction({p, 0, way}, {0, 0, 2 * way}, R);
    const double expected = (way - std::sqrt(inside * (R + p))) / (2 * way);
    // the error of the position is bounded, not that of the fraction: rounding p by eps R moves the contact
    // by sqrt(2 R eps R)
    EXPECT_NEAR(s, expected, 2e-9 / way) << inside;
  }
  EXPECT_EQ(FirstContactFraction({R + 1e-12, 0, way}, {0, 0, 2 * way}, R), kNoContact);
}

TEST(FirstContact, IsNoneForBallsThatMoveApart) {
  EXPECT_EQ(FirstContactFraction({0, 0, 5e-3}, {0, 0, -50e-3}, 4e-3), kNoContact);
  EXPECT_EQ(FirstContactFraction({0, 0, 5e-3}, {50e-3, 0, 0}, 4e-3), kNoContact);
}

// ---- pass 2: lens volume

/// Oracle: slices across the line of centres (midpoint rule).
double LensBySlices(double r1, double r2, double d) {
  constexpr int kSlices = 20'000;
  const double low = std::max(-r1, d - r2), high = std::min(r1, d + r2);
  if (high <= low) return 0.0;
  const double step = (high - low) / kSlices;
  double volume = 0.0;
  for (int i = 0; i < kSlices; ++i) {
    const double x = low + (i + 0.5) * step;
    volume += std::max(0.0, std::min(r1 * r1 - x * x, r2 * r2 - (x - d) * (x - d)));
  }
  return std::numbers::pi * volume * step;
}

TEST(LensVolume, AgreesWithSlices) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const double r1 = random.In(0.2, 30.0), r2 = random.In(0.2, 30.0);
    const double d = random.In(0.0, 1.1) * (r1 + r2);
    const double least = 4.0 / 3.0 * std::numbers::pi * std::pow(std::min(r1, r2), 3);
    // midpoint rule over 20 000 slices of a piecewise parabola: better than 1e-7 of the smaller ball
    ASSERT_NEAR(LensVolume(r1, r2, d), LensBySlices(r1, r2, d), 1e-7 * least) << r1 << " " << r2 << " " << d;
  }
}

TEST(LensVolume, IsTheVolumeOfAContainedBallAndZeroForBallsApart) {
  EXPECT_DOUBLE_EQ(LensVolume(5.0, 2.0, 3.0), 4.0 / 3.0 * std::numbers::pi * 8.0);
  EXPECT_DOUBLE_EQ(LensVolume(5.0, 2.0, 0.0), 4.0 / 3.0 * std::numbers::pi * 8.0);
  EXPECT_DOUBLE_EQ(LensVolume(2.0, 2.0, 0.0), 4.0 / 3.0 * std::numbers::pi * 8.0);
  EXPECT_EQ(LensVolume(5.0, 2.0, 7.0), 0.0);
  EXPECT_EQ(LensVolume(5.0, 2.0, 70.0), 0.0);
}

// As a function of the balls' distance, the volume has two joins: the smaller ball becomes contained, and the
// balls part. The slope is continuous at both joins. At a distance h from a join, the volume therefore
// differs from the constant value beyond it by the order of h^2.
TEST(LensVolume, IsSmoothWhereBallsPartAndWhereOneIsContained) {
  for (const double r2 : {0.3, 2.0, 4.5}) {
    const double r1 = 5.0, contained = 4.0 / 3.0 * std::numbers::pi * r2 * r2 * r2;
    for (const double h : {1e-2, 1e-3, 1e-4}) {
      const double inner = contained - LensVolume(r1, r2, r1 - r2 + h),
                   outer = LensVolume(r1, r2, r1 + r2 - h);
      // the slope is pi (lens radius)^2, and that radius^2 grows from 0 as 2 h r1 r2 / (r1 -+ r2)
      const double inner_expected = std::numbers::pi * r1 * r2 / (r1 - r2) * h * h;
      const double outer_expected = std::numbers::pi * r1 * r2 / (r1 + r2) * h * h;
      EXPECT_NEAR(inner, inner_expected, 0.15 * inner_expected) << r2 << " " << h;
      EXPECT_NEAR(outer, outer_expected, 0.15 * outer_expected) << r2 << " " << h;
    }
  }
}

TEST(LensVolume, IsSymmetricPositiveAndFallsWithDistance) {
  Random random(4);
  for (int i = 0; i < 300; ++i) {
    const double r1 = random.In(0.1, 30.0), r2 = random.In(0.1, 30.0);
    double before = 4.0 / 3.0 * std::numbers::pi * std::pow(std::min(r1, r2), 3);
    for (int k = 1; k < 100; ++k) {
      const double d = (r1 + r2) * k / 100.0, volume = LensVolume(r1, r2, d);
      ASSERT_DOUBLE_EQ(volume, LensVolume(r2, r1, d));
      ASSERT_GE(volume, 0.0);
      ASSERT_LE(volume, before * (1.0 + 1e-12));
      before = volume;
    }
  }
}

TEST(LensVolume, ScalesWithTheCubeOfLength) {
  // the equation as printed in the paper lacks two squares, so its result would depend on the unit of length
  EXPECT_NEAR(LensVolume(5e-3, 2e-3, 4e-3) * 1e9, LensVolume(5.0, 2.0, 4.0), 1e-12);
}

// ---- pass 3: shrinking

double DistanceToSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  return (p - ClosestOnSegment(p, a, b)).norm();
}

TEST(ClosestOnSegment, AgreesWithSampling) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const Vector3 a = random.Direction(), b = random.Direction(), p = 2.0 * random.Direction();
    double least = 10.0;
    for (int k = 0; k <= 2000; ++k) least = std::min(least, (p - (a + k / 2000.0 * (b - a))).norm());
    ASSERT_LE(DistanceToSegment(p, a, b), least + 1e-15);
    ASSERT_NEAR(DistanceToSegment(p, a, b), least, 2e-3);  // samples are up to 1e-3 apart
  }
  EXPECT_EQ(ClosestOnSegment({1, 2, 3}, {4, 5, 6}, {4, 5, 6}), Vector3(4, 5, 6));
}

/// Centre and radius of a ball after ShrinkBall, and whether it changed.
struct Shrunk {
  Vector3 c;
  double r;
  bool changed;
};
/// Ball (c, r) after the sweep of a tool ball of radius r_t from a to b.
Shrunk Shrink(Vector3 c, double r, const Vector3& a, const Vector3& b, double r_t) {
  const bool changed = ShrinkBall(c, r, a, b, r_t);
  return {c, r, changed};
}

TEST(ShrinkBall, KeepsTheBallInsideItsOldVolumeAndOutsideTheSweep) {
  Random random(6);
  int shrunk = 0, gone = 0, kept = 0;
  for (int i = 0; i < 50'000; ++i) {
    const double r_t = random.In(0.5e-3, 25e-3), r = random.In(0.1e-3, 3e-3);
    const Vector3 a = random.In(0.0, 10e-3) * random.Direction();
    const Vector3 b = i % 10 == 0 ? a : Vector3(a + random.In(0.0, 5e-3) * random.Direction());
    const Vector3 c = a + random.In(0, 1) * (b - a) + (r_t + random.In(-1.5, 1.5) * r) * random.Direction();
    const double p = r + r_t - DistanceToSegment(c, a, b);
    const Shrunk after = Shrink(c, r, a, b, r_t);
    ASSERT_EQ(after.changed, p > 0.0);
    if (p <= 0.0) {
      ++kept;
      ASSERT_EQ(after.c, c);
      ASSERT_EQ(after.r, r);
    } else if (p >= 2.0 * r || r - 0.5 * p < kMinBallRadius) {
      ++gone;
      ASSERT_EQ(after.r, 0.0);
    } else {
      ++shrunk;
      ASSERT_NEAR((after.c - c).norm(), r - after.r, 1e-12);  // hence inside the old ball
      ASSERT_NEAR(after.r, r - 0.5 * p, 1e-15);
      ASSERT_GE(DistanceToSegment(after.c, a, b) - after.r - r_t, -1e-14);  // no overlap remains
    }
  }
  EXPECT_GT(shrunk, 5000);
  EXPECT_GT(gone, 5000);
  EXPECT_GT(kept, 4000);
}

TEST(ShrinkBall, DeletesABallThatTheSweepContains) {
  const Vector3 a = Vector3::Zero(), b(0, 0, 1e-2);
  EXPECT_EQ(Shrink({4e-3, 0, 5e-3}, 1e-3, a, b, 5e-3).r, 0.0);  // p = 2r exactly: touches from inside
  EXPECT_EQ(Shrink({1e-3, 0, 5e-3}, 1e-3, a, b, 5e-3).r, 0.0);
  const Shrunk left = Shrink({4.1e-3, 0, 5e-3}, 1e-3, a, b, 5e-3);
  EXPECT_NEAR(left.r, 0.05e-3, 1e-15);
  EXPECT_NEAR(left.c.x(), 5.05e-3, 1e-15);
  Vector3 dead_center(6e-3, 0, 0);
  double dead = 0.0;
  EXPECT_FALSE(ShrinkBall(dead_center, dead, a, b, 7e-3));  // a deleted ball does not change any more
}

TEST(ShrinkBall, BeyondTheSegmentsEndMovesTheBallAwayFromTheEnd) {
  const Vector3 a = Vector3::Zero(), b(0, 0, 1e-2);
  const Vector3 u = Vector3(1, 2, 2) / 3.0;  // a direction in b's hemisphere
  const Shrunk after = Shrink(b + 5.5e-3 * u, 1e-3, a, b, 5e-3);
  EXPECT_LT((after.c - (b + 5.75e-3 * u)).norm(), 1e-15);
  EXPECT_NEAR(after.r, 0.75e-3, 1e-15);
}

// The ball's centre lies on the sweep's axis, so any direction perpendicular to the axis is right; the choice
// must be the same each time.
TEST(ShrinkBall, OnTheAxisMovesTheBallSidewaysAndAlwaysAlike) {
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Vector3 axis = i < 3 ? Vector3::Unit(i) : random.Direction();
    const Vector3 a = i % 2 == 0 ? Vector3(Vector3::Zero()) : Vector3(-3e-3 * axis), b = 4e-3 * axis;
    const double r = 10e-3, r_t = 2e-3;  // larger than the tool, so a part of the ball remains
    const Shrunk one = Shrink(Vector3::Zero(), r, a, b, r_t), two = Shrink(Vector3::Zero(), r, a, b, r_t);
    ASSERT_EQ(one.c, two.c);
    ASSERT_NEAR(one.r, 4e-3, 1e-15);
    ASSERT_NEAR(one.c.norm(), 6e-3, 1e-15);
    ASSERT_NEAR(one.c.dot(axis), 0.0, 1e-15);
    ASSERT_GE(DistanceToSegment(one.c, a, b) - one.r - r_t, -1e-14);
  }
  // a capsule without length: any finite direction is right
  const Shrunk point = Shrink(Vector3::Zero(), 10e-3, Vector3::Zero(), Vector3::Zero(), 2e-3);
  EXPECT_NEAR(point.c.norm(), 6e-3, 1e-15);
}

TEST(ShrinkBall, IsTheLargestBallInsideTheOldOneAndOutsideTheSweep) {
  Random random(8);
  for (int i = 0; i < 40; ++i) {
    const double r_t = random.In(1.0, 5.0), r = random.In(0.5, 3.0);
    const Vector3 a = Vector3::Zero(), b = random.In(0.0, 4.0) * random.Direction();
    const Vector3 c = a + random.In(0, 1) * (b - a) + (r_t + random.In(-0.8, 0.9) * r) * random.Direction();
    const Shrunk after = Shrink(c, r, a, b, r_t);
    if (!after.changed || after.r == 0.0) continue;
    // largest ball at a candidate centre: limited by the old ball's surface and the sweep
    const auto room = [&](const Vector3& x) {
      return std::min(r - (x - c).norm(), DistanceToSegment(x, a, b) - r_t);
    };
    double best = 0.0;
    Vector3 at = c;
    for (int k = 0; k < 20'000; ++k) {
      const Vector3 x = c + r * std::cbrt(random.In(0, 1)) * random.Direction();
      if (room(x) > best) best = room(at = x);
    }
    for (double step = 0.1 * r; step > 1e-9; step *= 0.7)  // random descent to the local best
      for (int k = 0; k < 60; ++k) {
        const Vector3 x = at + step * random.Direction();
        if (room(x) > best) best = room(at = x);
      }
    ASSERT_LE(best, after.r + 1e-12) << i;      // nothing larger is found
    if (after.r < 0.1 * r) continue;            // random points may miss a thin ball
    ASSERT_NEAR(best, after.r, 2e-3 * r) << i;  // the search is good enough to find it
  }
}

}  // namespace
}  // namespace osteon::simulation
