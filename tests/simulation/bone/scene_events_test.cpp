#include "simulation/bone/scene_events.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "simulation/solids/molar_solid.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of a scene's events: a region is reached, a wall is too thin, the tool breaks through.

namespace osteon::simulation {
namespace {

// A box of dentine around a box of pulp, both along the axes; G's origin is the middle of the top face.
class BoxInBox final : public Solid {
 public:
  enum : MaterialIndex { kDentine = 0, kPulp = 1 };
  BoxInBox() : outer_({-0.005, -0.004, -0.010}, {0.005, 0.004, 0.0}), pulp_({-0.002, -0.001, -0.008}, kTop) {}
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p) const override {
    return outer_.NearestSurface(p);
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p) const override {
    return pulp_.SignedDistance(p) < 0.0 ? kPulp : kDentine;
  }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return outer_.Bounds(); }
  [[nodiscard]] std::optional<SurfacePoint> RegionDistance(MaterialIndex material,
                                                           const Vector3& p) const override {
    if (material != kPulp) return std::nullopt;
    return pulp_.NearestSurface(p);
  }
  inline static const Vector3 kTop{0.002, 0.001, -0.004};  // the pulp begins 4 mm below the top

 private:
  BoxSolid outer_, pulp_;
};

// A bone without balls and points, with the materials dentine (0) and pulp (1) and its site at G's origin.
Bone DentineAndPulp() {
  Bone bone = EmptyBone();
  bone.materials.front().name = "dentine";
  bone.materials.push_back(bone.materials.front());
  bone.materials.back().name = "pulp";
  bone.site = {.center_m = Vector3::Zero(), .axis = Vector3::UnitZ(), .radius_m = 0.0015};
  return bone;
}

constexpr double kBurrRadius_m = 0.001;
// Watches the pulp, and walls thinner than 1.5 mm.
const SceneEventParams kPulpAndWall{
    .regions = {{.name = "pulp", .material = "pulp"}}, .min_wall_m = 0.0015, .wall_spacing_m = 0.5e-3};

// Moves a burr in BoxInBox and returns the events that the watch reports.
class Burr {
 public:
  explicit Burr(const SceneEventParams& params)
      : watch_(&solid_, DentineAndPulp(), BallTool(kBurrRadius_m), params) {}
  // The events of a frame with the burr's apex at this point of G; if `cuts`, the frame removes 1 mm^3.
  std::vector<SceneEvent> At(const Vector3& apex, bool cuts = true) {
    if (cuts) volume_m3_ += 1e-9;
    return watch_.Step(Down(apex), volume_m3_, ++stamp_);
  }
  const SceneWatch& watch() const { return watch_; }

 private:
  BoxInBox solid_;
  SceneWatch watch_;
  double volume_m3_{0.0};
  rt::Nanoseconds stamp_{0};
};

TEST(SceneEvents, PulpIsReachedExactlyWhereTheBurrTouchesIt) {
  // the apex: no event 1 um above the pulp's top, an event 1 um below it
  for (const Vector3& off : {Vector3(0, 0, 0), Vector3(0.0011, -0.0007, 0)}) {
    Burr burr({.regions = kPulpAndWall.regions});
    EXPECT_TRUE(burr.At(off + Vector3(0, 0, -0.001)).empty());
    EXPECT_TRUE(burr.At(off + Vector3(0, 0, -0.004 + 1e-6)).empty());
    const auto events = burr.At(off + Vector3(0, 0, -0.004 - 1e-6));
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].name, "pulp reached");
    EXPECT_EQ(events[0].stamp, 3);
    EXPECT_NEAR(events[0].value, 0.004, 1e-12);  // below the site
    EXPECT_LT((Vector3(events[0].p_G_m) - off - Vector3(0, 0, -0.004)).norm(), 1e-12);
  }
  // Beside the pulp's upper edge, the burr's side touches the edge when its centre is a radius from it.
  Burr burr({.regions = kPulpAndWall.regions});
  const double a = 0.6e-3, height = std::sqrt(kBurrRadius_m * kBurrRadius_m - a * a);
  const Vector3 beside(0.002 + a, 0,
                       -0.004 - kBurrRadius_m + height);  // the apex; the centre is a radius above
  EXPECT_TRUE(burr.At(beside + Vector3(0, 0, 1e-6)).empty());
  EXPECT_EQ(burr.At(beside - Vector3(0, 0, 1e-6)).size(), 1u);
}

TEST(SceneEvents, EachEventIsReportedOnce) {
  Burr burr(kPulpAndWall);
  const Vector3 in_the_pulp(0, 0, -0.005), at_the_wall(0.0035, 0, -0.003);
  EXPECT_EQ(burr.At(in_the_pulp).size(), 1u);
  EXPECT_TRUE(burr.At(in_the_pulp).empty());
  EXPECT_EQ(burr.At(at_the_wall).size(), 1u);
  EXPECT_TRUE(burr.At(at_the_wall + Vector3(1e-4, 0, 0)).empty());
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.4e-3, 1e-9);  // walls are still watched
  EXPECT_TRUE(burr.At(in_the_pulp).empty());
}

TEST(SceneEvents, AFrameWithoutRemovalCausesNoEvent) {
  Burr burr(kPulpAndWall);
  EXPECT_TRUE(burr.At({0, 0, -0.005}, false).empty());
  EXPECT_TRUE(burr.At({0.0035, 0, -0.003}, false).empty());
  EXPECT_FALSE(burr.watch().min_wall_m());
  EXPECT_FALSE(burr.At({0.0035, 0, -0.003}, true).empty());
}

// A slot is cut towards the +x side. Its wall's thickness is the distance from the burr's centre to the side
// less the burr's radius, at any height and also between the samples of the surface.
TEST(SceneEvents, WallOfASlotIsTheBoneLeftToTheSide) {
  for (const double spacing_m : {0.2e-3, 0.5e-3, 1.3e-3}) {
    SceneEventParams params = kPulpAndWall;
    params.regions.clear();
    params.wall_spacing_m = spacing_m;
    Burr burr(params);
    bool was_thin = false;
    for (double x = 0.0; x < 0.0039; x += 0.13e-3) {
      const Vector3 apex(x, 0.3e-3, -0.0031 - 0.1 * x);
      const auto events = burr.At(apex);
      // the nearer of the +x side, 5 mm - x away, and the +y side, 4 - 0.3 mm away
      const double wall_m = std::min(0.005 - x, 0.004 - 0.3e-3) - kBurrRadius_m;
      EXPECT_NEAR(*burr.watch().min_wall_m(), wall_m, 1e-9) << spacing_m << " " << x;
      const bool thin = wall_m < params.min_wall_m;
      EXPECT_EQ(!events.empty(), thin && !was_thin) << x;
      if (!events.empty()) {
        EXPECT_EQ(events[0].name, "wall too thin");
        EXPECT_NEAR(events[0].value, wall_m, 1e-9);
        EXPECT_LT((Vector3(events[0].p_G_m) - Vector3(0.005, apex.y(), apex.z() + kBurrRadius_m)).norm(),
                  1e-7);
      }
      was_thin = thin;
    }
    EXPECT_TRUE(was_thin);
    // the burr is through the wall: this is a separate event, reported once
    const auto through = burr.At({0.0043, 0, -0.003});
    ASSERT_EQ(through.size(), 1u);
    EXPECT_EQ(through[0].name, "breakthrough");
    EXPECT_NEAR(through[0].value, 0.003 - kBurrRadius_m, 1e-7);  // depth of the head's middle below the site
    EXPECT_EQ(*burr.watch().min_wall_m(), 0.0);
    EXPECT_TRUE(burr.At({0.0045, 0, -0.003}).empty());
    EXPECT_EQ(*burr.watch().min_wall_m(), 0.0);
  }
}

// The burr breaks through between two frames: both events come in one frame, and the wall is 0, not negative.
TEST(SceneEvents, ABreakthroughInOneFrameAlsoReportsTheThinWall) {
  SceneEventParams params = kPulpAndWall;
  params.regions.clear();
  Burr burr(params);
  const auto events = burr.At({0, 0, -0.0105});  // the floor is at -10 mm
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].name, "wall too thin");
  EXPECT_EQ(events[0].value, 0.0);
  EXPECT_EQ(events[1].name, "breakthrough");
  EXPECT_NEAR(events[1].value, 0.010, 1e-7);
  EXPECT_EQ(*burr.watch().min_wall_m(), 0.0);
}

// The bottom face counts as a wall, the top face with the opening does not.
TEST(SceneEvents, FaceWithTheOpeningIsNoWall) {
  SceneEventParams params = kPulpAndWall;
  params.regions.clear();
  Burr burr(params);
  burr.At({0, 0, -0.0022});
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.003, 1e-9);  // the sides along y, not the top face 0.2 mm away
  burr.At({0, 0, -0.0089});
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.0011, 1e-9);  // distance to the floor at -10 mm
}

// The fissures and steep inner slopes of the cusps around a molar's site are no walls. The crown's sides are
// walls, about 3 mm from an opening in the middle.
TEST(SceneEvents, CuspsOfAMolarAreNoWall) {
  const MolarSolid molar({});
  Bone bone = DentineAndPulp();
  const double top_m = 0.0051;  // height of the fissures
  bone.site = {.center_m = Vector3(0, 0, top_m), .axis = Vector3::UnitZ(), .radius_m = 0.00175};
  SceneWatch watch(&molar, bone, BallTool(kBurrRadius_m), {.min_wall_m = 1e-3, .wall_spacing_m = 0.25e-3});
  double volume_m3 = 0.0;
  for (double depth = 0.0; depth < 0.003; depth += 0.3e-3)
    for (double angle = 0.0; angle < 6.2; angle += 0.4) {
      const Vector3 apex(0.75e-3 * std::cos(angle), 0.75e-3 * std::sin(angle), top_m - depth);
      EXPECT_TRUE(watch.Step(Down(apex), volume_m3 += 1e-9, 1).empty()) << apex.transpose();
    }
  ASSERT_TRUE(watch.min_wall_m());
  EXPECT_GT(*watch.min_wall_m(), 0.002);
  EXPECT_LT(*watch.min_wall_m(), 0.0045);
}

// A cut from outside leaves no wall between the burr and the surface.
TEST(SceneEvents, ACutFromOutsideMeasuresNoWall) {
  SceneEventParams params = kPulpAndWall;
  params.regions.clear();
  Burr burr(params);
  EXPECT_TRUE(burr.At({0.0055, 0, -0.003}).empty());
  EXPECT_TRUE(burr.At({0.0, 0.0045, -0.003}).empty());
  EXPECT_FALSE(burr.watch().min_wall_m());
}

// BoxSolid does not implement RegionDistance, so the event occurs when the burr reaches the region's first
// mass point.
TEST(SceneEvents, RegionOfUnknownShapeIsReachedAtItsFirstMassPoint) {
  const BoxSolid solid({-0.005, -0.005, -0.010}, {0.005, 0.005, 0.0});
  Bone bone = DentineAndPulp();
  bone.points = {{.p_m = Vector3(0.0002, 0, -0.002), .volume_m3 = 1e-12, .material = 0},
                 {.p_m = Vector3(0, 0.0006, -0.004), .volume_m3 = 1e-12, .material = 1},
                 {.p_m = Vector3(0, 0, -0.005), .volume_m3 = 1e-12, .material = 1}};
  SceneWatch watch(&solid, bone, BallTool(kBurrRadius_m),
                   {.regions = {{.name = "pulp", .material = "pulp"}}});
  // the ball touches a point 0.6 mm beside the axis when the ball's apex is 0.2 mm below the point
  EXPECT_TRUE(watch.Step(Down({0, 0, -0.0042 + 1e-7}), 1e-9, 1).empty());
  const auto events = watch.Step(Down({0, 0, -0.0042 - 1e-7}), 2e-9, 2);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_NEAR(events[0].value, 0.004, 1e-12);
}

// A saved packing has no solid. Its mass points then represent the regions, and walls are not watched.
TEST(SceneEvents, WithoutASolidRegionsAreReachedAtMassPointsAndWallsAreNotWatched) {
  Bone bone = DentineAndPulp();
  bone.points = {{.p_m = Vector3(0, 0.0006, -0.004), .volume_m3 = 1e-12, .material = 1}};
  SceneWatch watch(nullptr, bone, BallTool(kBurrRadius_m), kPulpAndWall);
  EXPECT_TRUE(watch.Step(Down({0, 0, -0.0042 + 1e-7}), 1e-9, 1).empty());
  EXPECT_EQ(watch.Step(Down({0, 0, -0.0042 - 1e-7}), 2e-9, 2).size(), 1u);
  EXPECT_FALSE(watch.min_wall_m());
}

TEST(SceneEvents, RefusesUnknownMaterialsAndInvalidNumbers) {
  const BoxInBox solid;
  const Bone bone = DentineAndPulp();
  const auto make = [&](const SceneEventParams& params) {
    SceneWatch(&solid, bone, BallTool(kBurrRadius_m), params);
  };
  EXPECT_NO_THROW(make({}));
  EXPECT_NO_THROW(make(kPulpAndWall));
  try {
    make({.regions = {{.name = "nerve", .material = "enamel"}}});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "events: region nerve: material: found \"enamel\", accepted one of dentine, pulp");
  }
  EXPECT_THROW(make({.min_wall_m = -1e-3}), std::invalid_argument);
  EXPECT_THROW(make({.min_wall_m = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(make({.min_wall_m = 1e-3, .opening_widening = 0.5}), std::invalid_argument);
  EXPECT_THROW(make({.min_wall_m = 1e-3, .wall_spacing_m = 0.0}), std::invalid_argument);
}

// The generated molar's tissue is pulp exactly where its distance to the pulp is negative, and the returned
// nearest point is at that distance.
TEST(SceneEvents, MolarsPulpDistanceAgreesWithItsTissue) {
  const MolarSolid molar({});
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 share(0.5 + 0.5 * std::sin(1.7 * i), 0.5 + 0.5 * std::sin(2.9 * i),
                        0.5 + 0.5 * std::sin(0.7 * i));
    const Eigen::AlignedBox3d box = molar.Bounds();
    const Vector3 p = box.min() + share.cwiseProduct(box.sizes());
    const auto pulp = molar.RegionDistance(MolarSolid::kPulp, p);
    ASSERT_TRUE(pulp);
    EXPECT_NEAR((pulp->p_m - p).norm(), std::abs(pulp->distance_m), 1e-12);
    if (molar.SignedDistance(p) < 0.0) {
      EXPECT_EQ(pulp->distance_m < 0.0, molar.MaterialAt(p) == MolarSolid::kPulp) << p.transpose();
    }
    inside += pulp->distance_m < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 20);
  EXPECT_FALSE(molar.RegionDistance(MolarSolid::kDentine, Vector3::Zero()));  // dentine is no separate region
  EXPECT_FALSE(molar.RegionDistance(MolarSolid::kEnamel, Vector3::Zero()));
}

TEST(SurfaceSamples, LieOnABoxAndCoverItAtTheirSpacing) {
  const Vector3 low(-0.005, -0.004, -0.010), high(0.005, 0.004, 0.0);
  const BoxSolid solid(low, high);
  const double spacing_m = 0.6e-3;
  const SampleIndex samples(PointsOfSurface(solid, spacing_m));
  for (const OrientedPoint& sample : samples.samples()) {
    EXPECT_LT(std::abs(solid.SignedDistance(sample.p_m)), 1e-9);
    EXPECT_NEAR(sample.normal.norm(), 1.0, 1e-12);
  }
  // no point of a face is farther from a sample than a cell's diagonal in the plane
  for (double x = low.x(); x <= high.x(); x += 0.31e-3)
    for (double z = low.z(); z <= high.z(); z += 0.37e-3) {
      const Vector3 p(x, high.y(), z);
      const auto nearest = samples.Nearest(p);
      ASSERT_TRUE(nearest);
      EXPECT_LT((nearest->p_m - p).norm(), std::sqrt(2.0) * spacing_m);
    }
}

// Oracle: tests every sample within 4 mm; with only_ahead, only those whose normal points away from the
// query.
TEST(SurfaceSamples, IndexFindsTheNearestSample) {
  const std::vector<OrientedPoint> all =
      PointsOfSurface(BoxSolid({-0.01, -0.01, -0.02}, {0.01, 0.01, 0.0}), 0.9e-3);
  const SampleIndex index(all);
  ASSERT_EQ(index.size(), all.size());
  for (int i = 0; i < 200; ++i) {
    const Vector3 c(0.012 * std::sin(1.7 * i), 0.012 * std::sin(2.9 * i), -0.01 + 0.012 * std::sin(0.7 * i));
    for (const bool only_ahead : {false, true}) {
      double least = 0.004;
      for (const OrientedPoint& s : all)
        if (!only_ahead || (s.p_m - c).dot(s.normal) > 0.0) least = std::min(least, (s.p_m - c).norm());
      const auto found = index.Nearest(c, 0.004, only_ahead);
      EXPECT_NEAR(found ? (found->p_m - c).norm() : 0.004, least, 1e-15) << i;
    }
  }
}

}  // namespace
}  // namespace osteon::simulation
