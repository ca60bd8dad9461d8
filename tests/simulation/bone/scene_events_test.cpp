#include "simulation/bone/scene_events.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "simulation/solids/molar_solid.h"
#include "tests/simulation/engine/engine_bench.h"

namespace osteon::simulation {
namespace {

// A box of dentine around a box of pulp, both along the axes; G in the middle of the top face.
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

Bone DentineAndPulp() {
  Bone bone = EmptyBone();
  bone.materials.front().name = "dentine";
  bone.materials.push_back(bone.materials.front());
  bone.materials.back().name = "pulp";
  bone.site = {.center_m = Vector3::Zero(), .axis = Vector3::UnitZ(), .radius_m = 0.0015};
  return bone;
}

constexpr double kBurr_m = 0.001;
const SceneEventParams kPulpAndWall{
    .regions = {{.name = "pulp", .material = "pulp"}}, .min_wall_m = 0.0015, .wall_spacing_m = 0.5e-3};

// Steps a burr through poses, each of which removes bone.
class Burr {
 public:
  explicit Burr(const SceneEventParams& params)
      : watch_(&solid_, DentineAndPulp(), BallTool(kBurr_m), params) {}
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

TEST(SceneEvents, PulpIsReachedWhereTheApexMeetsIt) {
  // a further micrometre down triggers the event, anywhere above the pulp
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
  // past the pulp's edge by a and b: sqrt(a^2 + b^2) counts, not the height
  Burr burr({.regions = kPulpAndWall.regions});
  const double a = 0.6e-3, height = std::sqrt(kBurr_m * kBurr_m - a * a);
  const Vector3 beside(0.002 + a, 0, -0.004 - kBurr_m + height);  // the apex; the centre is a radius above
  EXPECT_TRUE(burr.At(beside + Vector3(0, 0, 1e-6)).empty());
  EXPECT_EQ(burr.At(beside - Vector3(0, 0, 1e-6)).size(), 1u);
}

TEST(SceneEvents, EachComesOnce) {
  Burr burr(kPulpAndWall);
  const Vector3 in_the_pulp(0, 0, -0.005), at_the_wall(0.0035, 0, -0.003);
  EXPECT_EQ(burr.At(in_the_pulp).size(), 1u);
  EXPECT_TRUE(burr.At(in_the_pulp).empty());
  EXPECT_EQ(burr.At(at_the_wall).size(), 1u);
  EXPECT_TRUE(burr.At(at_the_wall + Vector3(1e-4, 0, 0)).empty());
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.4e-3, 1e-9);  // the wall is still watched
  EXPECT_TRUE(burr.At(in_the_pulp).empty());
}

TEST(SceneEvents, NothingHappensWhereNothingIsCut) {
  Burr burr(kPulpAndWall);
  EXPECT_TRUE(burr.At({0, 0, -0.005}, false).empty());
  EXPECT_TRUE(burr.At({0.0035, 0, -0.003}, false).empty());
  EXPECT_FALSE(burr.watch().min_wall_m());
  EXPECT_FALSE(burr.At({0.0035, 0, -0.003}, true).empty());
}

// A slot towards the side: thickness = distance to the side's plane less the radius, at any height and place,
// also between samples 0.5 mm apart.
TEST(SceneEvents, WallOfASlotIsWhatIsLeftToTheSide) {
  for (const double spacing_m : {0.2e-3, 0.5e-3, 1.3e-3}) {
    SceneEventParams params = kPulpAndWall;
    params.regions.clear();
    params.wall_spacing_m = spacing_m;
    Burr burr(params);
    bool before = false;
    for (double x = 0.0; x < 0.0039; x += 0.13e-3) {
      const Vector3 apex(x, 0.3e-3, -0.0031 - 0.1 * x);
      const auto events = burr.At(apex);
      // the nearest of: +x side, +y side (4 - 0.3 mm away)
      const double wall_m = std::min(0.005 - x, 0.004 - 0.3e-3) - kBurr_m;
      EXPECT_NEAR(*burr.watch().min_wall_m(), wall_m, 1e-9) << spacing_m << " " << x;
      const bool thin = wall_m < params.min_wall_m;
      EXPECT_EQ(!events.empty(), thin && !before) << x;
      if (!events.empty()) {
        EXPECT_EQ(events[0].name, "wall too thin");
        EXPECT_NEAR(events[0].value, wall_m, 1e-9);
        EXPECT_LT((Vector3(events[0].p_G_m) - Vector3(0.005, apex.y(), apex.z() + kBurr_m)).norm(), 1e-7);
      }
      before = thin;
    }
    EXPECT_TRUE(before);
    // through the wall: nothing is left, which is a separate event, once
    const auto through = burr.At({0.0043, 0, -0.003});
    ASSERT_EQ(through.size(), 1u);
    EXPECT_EQ(through[0].name, "breakthrough");
    EXPECT_NEAR(through[0].value, 0.003 - kBurr_m, 1e-7);  // below the site, at the head's middle
    EXPECT_EQ(*burr.watch().min_wall_m(), 0.0);
    EXPECT_TRUE(burr.At({0.0045, 0, -0.003}).empty());
    EXPECT_EQ(*burr.watch().min_wall_m(), 0.0);
  }
}

// A drill that breaks through between two frames: both events at once, and no negative wall.
TEST(SceneEvents, AFastCutThroughIsTooThinAndThrough) {
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

// The floor is a wall, the face with the opening is not.
TEST(SceneEvents, OpeningIsNoWall) {
  SceneEventParams params = kPulpAndWall;
  params.regions.clear();
  Burr burr(params);
  burr.At({0, 0, -0.0022});
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.003, 1e-9);  // to the sides along y; 0.2 mm below the top
  burr.At({0, 0, -0.0089});
  EXPECT_NEAR(*burr.watch().min_wall_m(), 0.0011, 1e-9);  // to the floor at -10 mm
}

// Above a molar's site there are fissures and the cusps' steep inner slopes: none of them is a wall. The
// crown's sides are, about 3 mm from an opening in the middle.
TEST(SceneEvents, CuspsAreNoWall) {
  const MolarSolid molar({});
  Bone bone = DentineAndPulp();
  const double top_m = 0.0051;  // of the fissures
  bone.site = {.center_m = Vector3(0, 0, top_m), .axis = Vector3::UnitZ(), .radius_m = 0.00175};
  SceneWatch watch(&molar, bone, BallTool(kBurr_m), {.min_wall_m = 1e-3, .wall_spacing_m = 0.25e-3});
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

// Cutting the wall from outside is not a cut behind it.
TEST(SceneEvents, WallIsSeenFromWithinOnly) {
  SceneEventParams params = kPulpAndWall;
  params.regions.clear();
  Burr burr(params);
  EXPECT_TRUE(burr.At({0.0055, 0, -0.003}).empty());
  EXPECT_TRUE(burr.At({0.0, 0.0045, -0.003}).empty());
  EXPECT_FALSE(burr.watch().min_wall_m());
}

// For a solid without distances to its tissues: the event occurs at the first mass point that is cut.
TEST(SceneEvents, RegionOfUnknownShapeIsReachedWithItsFirstPoint) {
  const BoxSolid solid({-0.005, -0.005, -0.010}, {0.005, 0.005, 0.0});
  Bone bone = DentineAndPulp();
  bone.points = {{.p_m = Vector3(0.0002, 0, -0.002), .volume_m3 = 1e-12, .material = 0},
                 {.p_m = Vector3(0, 0.0006, -0.004), .volume_m3 = 1e-12, .material = 1},
                 {.p_m = Vector3(0, 0, -0.005), .volume_m3 = 1e-12, .material = 1}};
  SceneWatch watch(&solid, bone, BallTool(kBurr_m), {.regions = {{.name = "pulp", .material = "pulp"}}});
  // the ball meets the point 0.6 mm off the axis with its apex 0.2 mm below it
  EXPECT_TRUE(watch.Step(Down({0, 0, -0.0042 + 1e-7}), 1e-9, 1).empty());
  const auto events = watch.Step(Down({0, 0, -0.0042 - 1e-7}), 2e-9, 2);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_NEAR(events[0].value, 0.004, 1e-12);
}

// A saved packing has no solid.
TEST(SceneEvents, WithoutASolidItsPointsStandForARegionAndNoWallIsWatched) {
  Bone bone = DentineAndPulp();
  bone.points = {{.p_m = Vector3(0, 0.0006, -0.004), .volume_m3 = 1e-12, .material = 1}};
  SceneWatch watch(nullptr, bone, BallTool(kBurr_m), kPulpAndWall);
  EXPECT_TRUE(watch.Step(Down({0, 0, -0.0042 + 1e-7}), 1e-9, 1).empty());
  EXPECT_EQ(watch.Step(Down({0, 0, -0.0042 - 1e-7}), 2e-9, 2).size(), 1u);
  EXPECT_FALSE(watch.min_wall_m());
}

TEST(SceneEvents, RefusesWhatTheSceneHasNot) {
  const BoxInBox solid;
  const Bone bone = DentineAndPulp();
  const auto make = [&](const SceneEventParams& params) {
    SceneWatch(&solid, bone, BallTool(kBurr_m), params);
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

// The generated molar knows its pulp exactly: the tissue is pulp exactly where the distance is negative, and
// the nearest point lies on the pulp's border.
TEST(SceneEvents, MolarKnowsItsPulp) {
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
  EXPECT_FALSE(molar.RegionDistance(MolarSolid::kDentine, Vector3::Zero()));  // no region of its own
  EXPECT_FALSE(molar.RegionDistance(MolarSolid::kEnamel, Vector3::Zero()));
}

TEST(SurfaceSamples, CoverABoxAtTheirSpacing) {
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

// Oracle for the index: tests every sample.
TEST(SurfaceSamples, IndexFindsTheNearest) {
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
