#include "safety/zone.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace osteon::safety {
namespace {

const std::vector<ZoneShape> kShapes{ZoneShape::kHalfSpace, ZoneShape::kSphere, ZoneShape::kBox,
                                     ZoneShape::kCylinder, ZoneShape::kCapsule};

// Draws random points and zones from a fixed seed.
class Draw {
 public:
  double Within(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  // A vector in the cube from -max to max.
  Vector3 In(double max) { return {Within(-max, max), Within(-max, max), Within(-max, max)}; }
  ZoneParams Zone(ZoneShape shape, ZoneSide side) {
    return {.shape = shape,
            .side = side,
            .p_W_m = In(0.3),
            .R_W = Eigen::Quaterniond(Within(-1, 1), Within(-1, 1), Within(-1, 1), Within(-1, 1))
                       .normalized()
                       .toRotationMatrix(),
            .half_edge_m = {Within(0.05, 0.3), Within(0.05, 0.3), Within(0.05, 0.3)},
            .radius_m = Within(0.05, 0.3),
            .half_length_m = Within(0.05, 0.3)};
  }

 private:
  std::mt19937_64 random_{7};
};

// Whether a point is in the set, from its definition alone.
bool Inside(const ZoneParams& zone, const Vector3& p_WP) {
  const Vector3 p = zone.R_W.transpose() * (p_WP - zone.p_W_m);
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      return p.z() >= 0.0;
    case ZoneShape::kSphere:
      return p.norm() <= zone.radius_m;
    case ZoneShape::kBox:
      return (p.cwiseAbs().array() <= zone.half_edge_m.array()).all();
    case ZoneShape::kCylinder:
      return std::hypot(p.x(), p.y()) <= zone.radius_m && std::abs(p.z()) <= zone.half_length_m;
    case ZoneShape::kCapsule:
      for (int i = 0; i <= 2000; ++i) {  // balls along its axis
        const double z = zone.half_length_m * (i / 1000.0 - 1.0);
        if ((p - Vector3(0, 0, z)).norm() <= zone.radius_m) return true;
      }
      return false;
  }
  return false;
}

TEST(Zone, TheSignOfTheDistanceSaysOnWhichSideAPointIs) {
  Draw draw;
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 400; ++i) {
      const ZoneParams in = draw.Zone(shape, ZoneSide::kKeepIn);
      ZoneParams out = in;
      out.side = ZoneSide::kKeepOut;
      const Vector3 p = in.p_W_m + draw.In(0.6);
      const double in_m = ZoneBounds(in, p).distance_m(), out_m = ZoneBounds(out, p).distance_m();
      if (std::abs(in_m) < 1e-6 || std::abs(out_m) < 1e-6) continue;  // too close to the face
      EXPECT_EQ(in_m > 0.0, Inside(in, p)) << static_cast<int>(shape);
      EXPECT_EQ(out_m < 0.0, Inside(in, p)) << static_cast<int>(shape);
    }
}

// No point of the zone is nearer than the distance, and the zone begins at that distance in the bound's
// direction.
TEST(Zone, TheDistanceToAKeepOutZoneIsEuclidean) {
  Draw draw;
  for (const ZoneShape shape : kShapes)
    for (int i = 0; i < 200; ++i) {
      const ZoneParams zone = draw.Zone(shape, ZoneSide::kKeepOut);
      const Vector3 p = zone.p_W_m + draw.In(1.0);
      const ZoneBound bound = ZoneBounds(zone, p).all().front();
      if (bound.distance_m <= 1e-3) continue;
      EXPECT_NEAR(bound.toward_W.norm(), 1.0, 1e-12);
      EXPECT_TRUE(Inside(zone, p + (bound.distance_m + 1e-5) * bound.toward_W)) << static_cast<int>(shape);
      for (int j = 0; j < 50; ++j) {
        const Vector3 way = draw.In(1.0).normalized();
        EXPECT_FALSE(Inside(zone, p + (bound.distance_m - 1e-5) * way)) << static_cast<int>(shape);
      }
    }
}

// A step changes no distance by more than the step's length. The limits rely on this.
TEST(Zone, NoDistanceChangesFasterThanThePointMoves) {
  Draw draw;
  for (const ZoneShape shape : kShapes)
    for (const ZoneSide side : {ZoneSide::kKeepIn, ZoneSide::kKeepOut})
      for (int i = 0; i < 300; ++i) {
        const ZoneParams zone = draw.Zone(shape, side);
        const Vector3 p = zone.p_W_m + draw.In(0.5), step = draw.In(0.05);
        EXPECT_LE(std::abs(ZoneBounds(zone, p + step).distance_m() - ZoneBounds(zone, p).distance_m()),
                  step.norm() * (1.0 + 1e-12) + 1e-15);
      }
}

TEST(Zone, AKeepInBoxHasABoundForEachOfItsSixFaces) {
  const ZoneParams box{.shape = ZoneShape::kBox, .p_W_m = {1.0, 0.0, 0.0}, .half_edge_m = {0.1, 0.2, 0.3}};
  const ZoneBounds bounds(box, {1.05, 0.0, 0.0});
  ASSERT_EQ(bounds.all().size(), 6u);
  EXPECT_NEAR(bounds.distance_m(), 0.05, 1e-15);
  EXPECT_NEAR(bounds.all()[1].distance_m, 0.15, 1e-15);
}

TEST(Zone, RefusesZonesWithoutSizeOrValidRotation) {
  const auto refuses = [](ZoneParams zone) { EXPECT_THROW(Validate(zone), std::invalid_argument); };
  refuses({.shape = ZoneShape::kSphere, .radius_m = 0.0});
  refuses({.shape = ZoneShape::kBox, .half_edge_m = {0.1, -0.1, 0.1}});
  refuses({.shape = ZoneShape::kCapsule, .half_length_m = std::nan("")});
  refuses({.R_W = 2.0 * Matrix3::Identity()});
  EXPECT_NO_THROW(Validate({.shape = ZoneShape::kHalfSpace, .radius_m = -1.0})) << "it has no radius";
}

}  // namespace
}  // namespace osteon::safety
