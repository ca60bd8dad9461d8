#include "safety/guard_zone.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace osteon::safety {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr ZoneShape kShapes[] = {ZoneShape::kHalfSpace, ZoneShape::kSphere, ZoneShape::kBox,
                                 ZoneShape::kCylinder, ZoneShape::kCapsule};

// A zone about the origin, its axes along W's.
ZoneParams Plain(ZoneShape shape, ZoneSide side) {
  return {
      .shape = shape, .side = side, .half_edge_m = {0.1, 0.2, 0.3}, .radius_m = 0.1, .half_length_m = 0.2};
}

// Margin of p in a plain zone that keeps it in, or out [m]; negative beyond the bound.
double In(ZoneShape shape, const Vector3& p) { return GuardZoneMargin_m(Plain(shape, ZoneSide::kKeepIn), p); }
double Out(ZoneShape shape, const Vector3& p) {
  return GuardZoneMargin_m(Plain(shape, ZoneSide::kKeepOut), p);
}

TEST(GuardZone, DistancesAreAsWorkedOutByHand) {
  constexpr double kHandRounding = 1e-15;
  EXPECT_NEAR(In(ZoneShape::kHalfSpace, {5.0, -7.0, 0.02}), 0.02, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kHalfSpace, {5.0, -7.0, -0.02}), -0.02, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kSphere, {0.03, 0.04, 0.0}), 0.05, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kSphere, {0.0, 0.3, 0.4}), -0.4, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kBox, {-0.09, 0.0, 0.0}), 0.01, kHandRounding) << "to the nearest face";
  EXPECT_NEAR(In(ZoneShape::kBox, {0.0, 0.19, 0.0}), 0.01, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kBox, {0.0, 0.0, -0.29}), 0.01, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kBox, {0.13, -0.24, 0.0}), -0.05, kHandRounding)
      << "beyond an edge: 30 and 40 mm";
  EXPECT_NEAR(In(ZoneShape::kCylinder, {0.03, 0.04, 0.0}), 0.05, kHandRounding) << "to its side";
  EXPECT_NEAR(In(ZoneShape::kCylinder, {0.0, 0.0, -0.19}), 0.01, kHandRounding) << "to an end";
  EXPECT_NEAR(In(ZoneShape::kCylinder, {0.13, 0.0, 0.24}), -0.05, kHandRounding) << "beyond its rim";
  EXPECT_NEAR(In(ZoneShape::kCapsule, {0.0, 0.03, 0.2}), 0.07, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kCapsule, {0.0, 0.0, -0.33}), -0.03, kHandRounding);
  EXPECT_NEAR(In(ZoneShape::kCapsule, {0.03, 0.0, 0.24}), 0.05, kHandRounding);
}

TEST(GuardZone, TheMarginOfAKeepOutZoneIsTheNegativeOfTheKeepInZones) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 200; ++i) {
      const Vector3 p(within(random), within(random), within(random));
      EXPECT_EQ(Out(shape, p), -In(shape, p));
    }
}

// Moving and rotating a set is equivalent to moving and rotating the point the opposite way.
TEST(GuardZone, MovesAndRotatesWithItsPose) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 200; ++i) {
      ZoneParams zone = Plain(shape, ZoneSide::kKeepIn);
      zone.p_W_m = Vector3(within(random), within(random), within(random));
      const Vector3 axis = Vector3(within(random), within(random), within(random)).normalized();
      zone.R_W = Eigen::AngleAxisd(6.0 * within(random), axis).toRotationMatrix();
      const Vector3 p_Z(within(random), within(random), within(random));
      EXPECT_NEAR(GuardZoneMargin_m(zone, zone.p_W_m + zone.R_W * p_Z), In(shape, p_Z), 1e-14);
    }
}

// A Euclidean distance changes by at most the length of a step. Outside the zone, its gradient has the length
// 1, and a step against the gradient by the distance ends on the zone's surface.
TEST(GuardZone, DistancesFromOutsideAreEuclidean) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> within(-0.6, 0.6);
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 400; ++i) {
      const Vector3 p(within(random), within(random), within(random));
      const double distance_m = Out(shape, p);
      const Vector3 step = 0.05 * Vector3(within(random), within(random), within(random));
      EXPECT_LE(std::abs(Out(shape, p + step) - distance_m), step.norm() + 1e-14);
      if (distance_m <= 1e-3) continue;
      constexpr double kStep_m = 1e-6;
      Vector3 gradient;
      for (int j = 0; j < 3; ++j)
        gradient[j] =
            (Out(shape, p + kStep_m * Vector3::Unit(j)) - Out(shape, p - kStep_m * Vector3::Unit(j))) /
            (2.0 * kStep_m);
      EXPECT_NEAR(gradient.norm(), 1.0, 1e-4);
      EXPECT_NEAR(Out(shape, p - distance_m * gradient), 0.0, 1e-5);
    }
}

TEST(GuardZone, APointThatIsNotFiniteIsNeverInside) {
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 3; ++i)
      for (const ZoneSide side : {ZoneSide::kKeepIn, ZoneSide::kKeepOut}) {
        Vector3 p = Vector3::Zero();
        p[i] = kNaN;
        EXPECT_FALSE(GuardZoneMargin_m(Plain(shape, side), p) >= -1.0) << static_cast<int>(shape) << i;
      }
}

TEST(GuardZone, RefusesZonesWithoutSizeOrValidPose) {
  const auto refuses = [](ZoneParams zone) { EXPECT_THROW(RequireGuardZone(zone), std::invalid_argument); };
  refuses({.shape = ZoneShape::kSphere, .radius_m = 0.0});
  refuses({.shape = ZoneShape::kCapsule, .radius_m = kNaN});
  refuses({.shape = ZoneShape::kCylinder, .half_length_m = -1.0});
  refuses({.shape = ZoneShape::kBox, .half_edge_m = {0.1, 0.1, 0.0}});
  refuses({.shape = ZoneShape::kHalfSpace, .R_W = 1.01 * Matrix3::Identity()});
  refuses({.shape = ZoneShape::kHalfSpace, .p_W_m = {0.0, kNaN, 0.0}});
  EXPECT_NO_THROW(RequireGuardZone({.shape = ZoneShape::kHalfSpace, .radius_m = 0.0})) << "it has none";
}

}  // namespace
}  // namespace osteon::safety
