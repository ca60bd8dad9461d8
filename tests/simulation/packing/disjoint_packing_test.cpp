#include "simulation/packing/disjoint_packing.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <random>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulation/bone/scenes.h"
#include "simulation/solids/acetabulum_solid.h"
#include "tests/simulation/mesh/mesh_shapes.h"
#include "tests/simulation/solids/simple_solids.h"

// Tests of packings of disjoint balls: every ball lies in the solid, none overlaps another, and no hole is
// left for a larger ball.

namespace osteon::simulation {
namespace {

double Volume_m3(std::span<const Ball> balls) {
  double volume = 0.0;
  for (const Ball& ball : balls)
    volume += 4.0 / 3.0 * std::numbers::pi * ball.radius_m * ball.radius_m * ball.radius_m;
  return volume;
}

std::vector<double> RadiiDescending(std::span<const Ball> balls) {
  std::vector<double> radii;
  for (const Ball& ball : balls) radii.push_back(ball.radius_m);
  std::sort(radii.rbegin(), radii.rend());
  return radii;
}

/// Distance from p to the ball's surface, negative inside.
double Gap_m(const Ball& ball, const Vector3& p) {
  return (p - Vector3(ball.center_m)).norm() - ball.radius_m;
}

/// Checks by plain loops that balls are within the solid and none overlaps another, to a picometre of
/// rounding.
void ExpectDisjointAndInside(const Solid& solid, std::span<const Ball> balls) {
  for (std::size_t i = 0; i < balls.size(); ++i) {
    ASSERT_LE(solid.SignedDistance(balls[i].center_m) + balls[i].radius_m, 1e-12);
    for (std::size_t j = 0; j < i; ++j)
      ASSERT_GE(Gap_m(balls[i], balls[j].center_m) - balls[j].radius_m, -1e-12) << i << " and " << j;
  }
}

/// Oracle, independent of the packer: radius of the largest free ball found from `probes` random points, each
/// of which climbs by random steps towards larger clearance.
double LargestHole_m(const Solid& solid, std::span<const Ball> balls, int probes) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto clearance = [&](const Vector3& p) {
    double c = -solid.SignedDistance(p);
    for (const Ball& ball : balls) c = std::min(c, Gap_m(ball, p));
    return c;
  };
  double largest = 0.0;
  for (int i = 0; i < probes; ++i) {
    const Eigen::AlignedBox3d box = solid.Bounds();
    Vector3 p = box.min() + box.sizes().cwiseProduct(Vector3(unit(random), unit(random), unit(random)));
    double c = clearance(p);
    if (c < 0.0) continue;
    double stride = c;
    for (int k = 0; k < 30; ++k) {
      const Vector3 q =
          p + stride * (Vector3(unit(random), unit(random), unit(random)) - Vector3::Constant(0.5));
      const double there = clearance(q);
      if (there > c) {
        p = q;
        c = there;
      } else {
        stride *= 0.85;
      }
    }
    largest = std::max(largest, c);
  }
  return largest;
}

TEST(DisjointPacking, BallsAreInsideAndDisjointInEveryShape) {
  const AcetabulumSolid acetabulum({});
  const BoxSolid plate = CenteredBox(Vector3(0.06, 0.04, 0.002));
  const MeshSolid mesh(MakeIcosphere(Vector3(0.1, 0, 0), 0.02, 1));
  for (const Solid* solid : std::initializer_list<const Solid*>{&acetabulum, &plate, &mesh})
    for (const double max_radius_m : {1.0, 1.5e-3}) {
      const DisjointParams params{.count = 800, .max_radius_m = max_radius_m, .seed = 5};
      const std::vector<Ball> balls = BuildDisjointPacking(*solid, EverywhereZone(), params);
      EXPECT_EQ(balls.size(), 800u);
      ExpectDisjointAndInside(*solid, balls);
    }
}

// In a cube of side a: the inscribed ball, then in each of the eight corners a ball that touches three faces
// and the inscribed ball, r = (2 - sqrt 3) a/2.
TEST(DisjointPacking, StartsWithTheInscribedBallAndThenFillsTheCorners) {
  const std::vector<double> radii = RadiiDescending(
      BuildDisjointPacking(CenteredBox(Vector3(0.1, 0.1, 0.1)), EverywhereZone(), {.count = 9}));
  ASSERT_EQ(radii.size(), 9u);
  EXPECT_NEAR(radii[0], 0.05, 1e-6 * 0.05);  // tolerance at which climbs end
  for (int i = 1; i < 9; ++i) EXPECT_NEAR(radii[i], (2.0 - std::sqrt(3.0)) * 0.05, 1e-5 * 0.05);
}

TEST(DisjointPacking, ABallIsFilledByASingleBall) {
  const std::vector<Ball> balls =
      BuildDisjointPacking(BallSolid(0.02), EverywhereZone(), {.count = 0, .min_radius_m = 1e-3});
  ASSERT_EQ(balls.size(), 1u);
  EXPECT_NEAR(balls[0].radius_m, 0.02, 1e-6 * 0.02);
}

// Balls are placed in descending classes of radius, 5 % wide. No remaining hole may therefore be more than 5
// % larger than the smallest ball.
TEST(DisjointPacking, LeavesNoHoleLargerThanItsSmallestBall) {
  const AcetabulumSolid solid({});
  for (const std::size_t count : {30, 300, 1500}) {
    const std::vector<Ball> balls = BuildDisjointPacking(solid, EverywhereZone(), {.count = count});
    const double least = RadiiDescending(balls).back();
    const double hole = LargestHole_m(solid, balls, 3000);
    EXPECT_LT(hole, least / 0.95);
    EXPECT_GT(hole, 0.5 * least);  // the probes do find holes
  }
}

TEST(DisjointPacking, WithoutACountFillsUntilNoBallFits) {
  const AcetabulumSolid acetabulum(
      {.width_m = 0.04, .height_m = 0.03, .cup_radius_m = 0.012, .cartilage_m = 1e-3, .subchondral_m = 1e-3});
  const BoxSolid plate = CenteredBox(Vector3(0.06, 0.04, 0.003));
  for (const Solid* solid : std::initializer_list<const Solid*>{&acetabulum, &plate})
    for (const double max_radius_m : {1.0, 1.4e-3}) {
      const double least = 1.2e-3;
      const std::vector<Ball> balls = BuildDisjointPacking(
          *solid, EverywhereZone(), {.count = 0, .min_radius_m = least, .max_radius_m = max_radius_m});
      EXPECT_GT(balls.size(), 100u);
      EXPECT_GE(RadiiDescending(balls).back(), least - 2e-12);
      EXPECT_LT(LargestHole_m(*solid, balls, 4000), 1.02 * least);
    }
}

// If the count does not fit, the result is a full packing with fewer balls than the count.
TEST(DisjointPacking, ReturnsFewerBallsThanTheCountIfNoMoreFit) {
  const BoxSolid box = CenteredBox(Vector3(0.02, 0.02, 0.02));
  const DisjointParams until_full{.count = 0, .min_radius_m = 1e-3};
  const DisjointParams too_many{.count = 100'000, .min_radius_m = 1e-3};
  const auto full = BuildDisjointPacking(box, EverywhereZone(), until_full);
  const auto asked = BuildDisjointPacking(box, EverywhereZone(), too_many);
  EXPECT_LT(asked.size(), 1000u);
  EXPECT_NEAR(static_cast<double>(asked.size()), static_cast<double>(full.size()),
              0.1 * static_cast<double>(full.size()));
}

bool SameBits(const std::vector<Ball>& a, const std::vector<Ball>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Ball)) == 0;
}

TEST(DisjointPacking, EqualsBitForBitForAnyNumberOfThreads) {
  const MeshSolid mesh(MakeBox(Vector3(0.1, 0, 0), Vector3(0.13, 0.04, 0.05)));
  const AcetabulumSolid acetabulum({});
  const CupZone cup(acetabulum.cup());
  const EverywhereZone everywhere;
  const auto expect_same = [](const Solid& solid, const CutZone& zone, DisjointParams params) {
    params.threads = 1;
    const std::vector<Ball> one = BuildDisjointPacking(solid, zone, params);
    for (const int threads : {2, 8}) {
      params.threads = threads;
      EXPECT_TRUE(SameBits(one, BuildDisjointPacking(solid, zone, params))) << threads;
    }
  };
  expect_same(mesh, everywhere, {.count = 3000});
  expect_same(acetabulum, cup, {.count = 2000, .max_radius_m = 1e-3, .grade = 0.2});
  expect_same(acetabulum, everywhere, {.count = 0, .min_radius_m = 2.5e-3});
}

TEST(DisjointPacking, AnotherSeedGivesADifferentPackingOfEqualVolume) {
  const AcetabulumSolid solid({});
  const auto with_seed = [&](std::uint64_t seed) {
    return BuildDisjointPacking(solid, EverywhereZone(), {.count = 1000, .seed = seed});
  };
  const std::vector<Ball> first = with_seed(1), second = with_seed(2);
  EXPECT_TRUE(SameBits(first, with_seed(1)));
  EXPECT_FALSE(SameBits(first, second));
  EXPECT_NEAR(Volume_m3(second) / Volume_m3(first), 1.0, 0.01);
}

// Limit of a radius: 0.8 mm in the zone, plus 0.3 mm for each millimetre of depth below it.
TEST(DisjointPacking, RadiiReachAndKeepTheLimitThatGrowsWithDepth) {
  const AcetabulumSolid solid({});
  const CupZone zone(solid.cup());
  const DisjointParams params{.count = 3000, .max_radius_m = 0.8e-3, .grade = 0.3};
  const std::vector<Ball> balls = BuildDisjointPacking(solid, zone, params);
  ExpectDisjointAndInside(solid, balls);
  int at_cap = 0;
  for (const Ball& ball : balls) {
    const double cap = 0.8e-3 + 0.3 * std::max(0.0, zone.DepthAt(ball.center_m));
    ASSERT_LE(ball.radius_m, cap);
    at_cap += ball.radius_m > 0.999 * cap;
  }
  EXPECT_GT(at_cap, 100);
  EXPECT_GT(RadiiDescending(balls).front(), 5e-3);
}

// All balls have a radius of 1 mm. Poured balls that roll to rest fill about 0.56 to 0.60 of the space
// without walls (loose random packings: Onoda, Liniger, Phys. Rev. Lett. 64, 1990: 0.555). Walls 20 diameters
// apart reduce this by 0.03.
TEST(DisjointPacking, EqualBallsAreAsDenseAsPouredOnes) {
  const BoxSolid box = CenteredBox(Vector3(0.04, 0.04, 0.04));
  const std::vector<Ball> balls = BuildDisjointPacking(
      box, EverywhereZone(), {.count = 0, .min_radius_m = 0.999e-3, .max_radius_m = 1e-3});
  EXPECT_GT(Volume_m3(balls) / Volume_m3(box), 0.52);
}

// The lower limits are close to this packer's own results, so that the test notices if the packer becomes
// worse. One ball covers pi/6 of a cube.
TEST(DisjointPacking, CoverageOfACubeIsNotBelowItsKnownValues) {
  const BoxSolid box = CenteredBox(Vector3(0.1, 0.1, 0.1));
  double last = 0.0;
  for (const auto& [count, least] : {std::pair{1, 0.523}, {100, 0.7}, {1000, 0.8}, {8000, 0.85}}) {
    const DisjointParams params{.count = static_cast<std::size_t>(count)};
    const double coverage = Volume_m3(BuildDisjointPacking(box, EverywhereZone(), params)) / Volume_m3(box);
    printf("coverage of a cube by %5d balls: %.4f\n", count, coverage);
    EXPECT_GT(coverage, least);
    EXPECT_GT(coverage, last);
    last = coverage;
  }
}

TEST(DisjointPacking, RefusesParametersOutOfRangeByName) {
  const auto message = [](const DisjointParams& params) -> std::string {
    try {
      (void)BuildDisjointPacking(CenteredBox(Vector3(0.01, 0.01, 0.01)), EverywhereZone(), params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({.min_radius_m = 0.0}), HasSubstr("least radius: found 0 mm, accepted 0.001 … 100 mm"));
  EXPECT_THAT(message({.min_radius_m = NAN}), HasSubstr("least radius: found nan mm"));
  EXPECT_THAT(message({.min_radius_m = 2e-3, .max_radius_m = 1e-3}),
              HasSubstr("greatest radius: found 1 mm, accepted 2 … 1000 mm"));
  EXPECT_THAT(message({.count = 200'000'000}), HasSubstr("count: found 200000000, accepted 0 … 100000000"));
  EXPECT_THAT(message({.grade = -0.1}), HasSubstr("grade: found -0.1, accepted 0 … 1"));
  EXPECT_THAT(message({.threads = -1}), HasSubstr("threads: found -1, accepted 0 … 1024"));
}

// A real bone, if the folder of anatomical meshes is available. OpenVDB's fillWithSpheres covers 0.776 of
// this bone with 10 000 balls; half as many must cover more.
TEST(DisjointPacking, CoversTheHipBoneBetterThanOpenVdb) {
  const char* folder = std::getenv("OSTEON_DATA_DIR");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : "") / "hip_bone_left.obj";
  if (!folder || !std::filesystem::exists(path)) GTEST_SKIP() << "no anatomical meshes";
  const auto loaded = LoadMesh(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const MeshSolid solid(loaded->mesh);
  const std::vector<Ball> balls = BuildDisjointPacking(solid, EverywhereZone(), {.count = 5000});
  const double coverage = Volume_m3(balls) / SignedVolume_m3(loaded->mesh);
  printf("coverage of the hip bone by 5000 balls: %.4f\n", coverage);
  EXPECT_GT(coverage, 0.80);
  ExpectDisjointAndInside(solid, balls);
}

}  // namespace
}  // namespace osteon::simulation
