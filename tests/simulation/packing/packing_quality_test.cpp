#include "simulation/packing/packing_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#include <gmock/gmock.h>

#include "simulation/packing/ball_forest.h"
#include "simulation/solids/acetabulum_solid.h"
#include "tests/simulation/engine/engine_bench.h"

// Tests of the measured quality of a packing (coverage, gaps, overlap, protrusion) against closed forms and
// plain loops.

namespace osteon::simulation {
namespace {

using std::numbers::pi;

double BallVolume_m3(double r) { return 4.0 / 3.0 * pi * r * r * r; }

/// A cube about the origin.
BoxSolid Cube(double side_m) { return {Vector3::Constant(-0.5 * side_m), Vector3::Constant(0.5 * side_m)}; }

/// Balls at random places in a cube of 100 mm with radii from 0.1 to 20 mm, equally many in each octave:
/// small balls inside large ones, and large balls that overlap by centimetres.
std::vector<Ball> RandomBalls(std::size_t count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<Ball> balls(count);
  for (Ball& ball : balls)
    ball = {.center_m = Vector3(0.05 * u(random), 0.05 * u(random), 0.05 * u(random)),
            .radius_m = std::sqrt(0.1e-3 * 20e-3) * std::pow(200.0, 0.5 * u(random))};
  return balls;
}

TEST(PackingQuality, CoverageOfOneBallIsItsShareOfTheBox) {
  const std::vector<Ball> ball{{.center_m = Vector3(1e-3, -0.5e-3, 0.3e-3), .radius_m = 8e-3}};
  const PackingQuality quality = MeasurePacking(Cube(0.020), ball, {.samples = 100'000});
  const double exact = BallVolume_m3(8e-3) / std::pow(0.020, 3);
  EXPECT_GT(quality.volume_samples, 80'000u);
  EXPECT_LT(quality.volume_samples, 130'000u);
  EXPECT_NEAR(quality.coverage_standard_error,
              std::sqrt(exact * (1 - exact) / static_cast<double>(quality.volume_samples)), 1e-5);
  EXPECT_NEAR(quality.coverage, exact, 3.0 * quality.coverage_standard_error);
}

// Two balls of radius r whose centres are d apart share a lens of volume pi (4r + d)(2r - d)^2 / 12.
TEST(PackingQuality, CoverageCountsSharedVolumeOnce) {
  const double r = 6e-3, d = 5e-3;
  const std::vector<Ball> balls{{.center_m = Vector3(-0.5 * d, 0, 0), .radius_m = r},
                                {.center_m = Vector3(0.5 * d, 0, 0), .radius_m = r}};
  const PackingQuality quality = MeasurePacking(Cube(0.020), balls, {.samples = 100'000});
  const double lens = pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12.0;
  EXPECT_NEAR(quality.coverage, (2 * BallVolume_m3(r) - lens) / std::pow(0.020, 3),
              3.0 * quality.coverage_standard_error);
  EXPECT_NEAR(quality.overlap_max_m, 2 * r - d, 1e-15);
}

// Touching balls on a cubic lattice fill pi/6 of a cube. On a face of the cube, the gap at a distance rho
// from the point where a ball touches the face is sqrt(r^2 + rho^2) - r.
TEST(PackingQuality, ACubicLatticeHasTheExactDensityAndGapsAndNoOverlap) {
  const double r = 0.5e-3;
  std::vector<Ball> balls;
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < 20; ++k)
        balls.push_back({.center_m = Vector3(2 * r * Vector3(i - 9.5, j - 9.5, k - 9.5)), .radius_m = r});
  const PackingQuality quality =
      MeasurePacking(Cube(0.020), balls, {.samples = 200'000, .surface_samples = 100'000});
  EXPECT_NEAR(quality.coverage, pi / 6.0, 3.0 * quality.coverage_standard_error);
  EXPECT_NEAR(quality.overlap_max_m, 0.0, 1e-15);
  EXPECT_NEAR(quality.protrusion_max_m, 0.0, 1e-15);
  EXPECT_EQ(quality.spheres, 8000u);
  std::vector<double> exact;
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 400; ++j)
      exact.push_back(std::sqrt(r * r + r * r * (std::pow((i + .5) / 400, 2) + std::pow((j + .5) / 400, 2))) -
                      r);
  std::sort(exact.begin(), exact.end());
  const double mean = std::accumulate(exact.begin(), exact.end(), 0.0) / static_cast<double>(exact.size());
  // Tolerance of the mean: 100 000 samples have a standard error of 0.3 %. In addition, the cube's edges have
  // 0.5 % too many samples, with gaps of 0.2 mm instead of the mean of 0.14 mm.
  EXPECT_NEAR(quality.surface_gap_mean_m, mean, 0.012 * mean);
  EXPECT_NEAR(quality.surface_gap_p95_m, exact[exact.size() * 95 / 100], 0.02 * exact.back());
  EXPECT_NEAR(quality.surface_gap_max_m, (std::sqrt(3.0) - 1.0) * r, 0.02 * r);  // a corner of the cube
}

TEST(PackingQuality, ProtrusionIsTheLargestOfAllBalls) {
  std::vector<Ball> balls;
  for (int i = -4; i <= 4; ++i)
    balls.push_back({.center_m = Vector3(2e-3 * i, 0, 0), .radius_m = 1e-3});  // 1 mm inside
  const PackingQuality inside =
      MeasurePacking(Cube(0.020), balls, {.samples = 1000, .surface_samples = 1000});
  EXPECT_NEAR(inside.protrusion_max_m, -1e-3, 1e-15);
  balls.push_back({.center_m = Vector3(0, 8e-3, 0), .radius_m = 2.3e-3});
  const PackingQuality outside =
      MeasurePacking(Cube(0.020), balls, {.samples = 1000, .surface_samples = 1000});
  EXPECT_NEAR(outside.protrusion_max_m, 0.3e-3, 1e-15);
  EXPECT_EQ(outside.r_min_m, 1e-3);
  EXPECT_EQ(outside.r_max_m, 2.3e-3);
}

// With more than 4096 balls, boxes of balls deep inside are skipped. A single small ball that protrudes
// slightly must still be found.
TEST(PackingQuality, ProtrusionOfOneBallIsFoundAmongManyInside) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<Ball> balls;
  for (int i = 0; i < 50'000; ++i)
    balls.push_back({.center_m = Vector3(9e-3 * u(random), 9e-3 * u(random), 9e-3 * u(random)),
                     .radius_m = 0.2e-3 * std::pow(4.0, u(random))});
  balls[31'234] = {.center_m = Vector3(3e-3, 9.9e-3, -2e-3), .radius_m = 0.15e-3};
  EXPECT_NEAR(MeasurePacking(Cube(0.020), balls, {.samples = 1000, .surface_samples = 1000}).protrusion_max_m,
              0.05e-3, 1e-15);
}

// Oracle: loops over all balls and all pairs. The radii extend over eight octaves.
TEST(BallForest, GapAndOverlapEqualThoseOfPlainLoops) {
  const std::vector<Ball> balls = RandomBalls(1500);
  for (const std::size_t count : {1u, 2u, 7u, 33u, 1500u}) {
    const BallForest forest(std::span<const Ball>(balls).first(count));
    double overlap = 0.0;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j)
        overlap = std::max(overlap, balls[i].radius_m + balls[j].radius_m -
                                        (Vector3(balls[i].center_m) - Vector3(balls[j].center_m)).norm());
    EXPECT_EQ(forest.MaxOverlap(3), overlap) << count;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-0.07, 0.07);
    for (int i = 0; i < 500; ++i) {
      const Vector3 p(u(random), u(random), u(random));
      double gap = 1.0;
      for (std::size_t j = 0; j < count; ++j)
        gap = std::min(gap, (p - Vector3(balls[j].center_m)).norm() - balls[j].radius_m);
      ASSERT_EQ(forest.Gap(p), std::max(0.0, gap)) << count << " " << p.transpose();
    }
  }
}

// The packing has no balls, so nothing is covered and the gap is infinite. The solid's volume and area are
// measured nevertheless.
TEST(PackingQuality, SamplesMeasureTheAcetabulumsVolumeAndArea) {
  const double R = 0.024;
  const PackingQuality quality =
      MeasurePacking(AcetabulumSolid({}), {}, {.samples = 200'000, .surface_samples = 100'000});
  EXPECT_NEAR(quality.solid_volume_m3, 0.08 * 0.08 * 0.06 - 0.5 * BallVolume_m3(R),
              0.003 * quality.solid_volume_m3);
  // The block has 2 (80² + 2·80·60) mm² of faces; the cup replaces pi R² of them by 2 pi R². The samples give
  // 0.3 %.
  EXPECT_NEAR(quality.surface_area_m2, 2 * 0.08 * 0.08 + 4 * 0.08 * 0.06 + pi * R * R,
              0.01 * quality.surface_area_m2);
  EXPECT_EQ(quality.coverage, 0.0);
  EXPECT_EQ(quality.surface_gap_mean_m, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(quality.radius_histogram.empty());
}

TEST(PackingQuality, EqualsBitForBitForAnyNumberOfThreads) {
  const std::vector<Ball> balls = RandomBalls(6000);
  const BoxSolid box = Cube(0.1);
  const PackingQuality one =
      MeasurePacking(box, balls, {.samples = 20'000, .surface_samples = 10'000, .threads = 1});
  for (const int threads : {2, 8}) {
    const PackingQuality many =
        MeasurePacking(box, balls, {.samples = 20'000, .surface_samples = 10'000, .threads = threads});
    EXPECT_EQ(many.coverage, one.coverage);
    EXPECT_EQ(many.surface_gap_mean_m, one.surface_gap_mean_m);
    EXPECT_EQ(many.surface_gap_p95_m, one.surface_gap_p95_m);
    EXPECT_EQ(many.surface_gap_max_m, one.surface_gap_max_m);
    EXPECT_EQ(many.protrusion_max_m, one.protrusion_max_m);
    EXPECT_EQ(many.overlap_max_m, one.overlap_max_m);
  }
}

TEST(PackingQuality, EveryBallIsCountedInItsHistogramBin) {
  const std::vector<Ball> balls = RandomBalls(4000);
  const PackingQuality quality = MeasurePacking(Cube(0.1), balls, {.samples = 1000, .surface_samples = 1000});
  std::size_t sum = 0;
  for (const RadiusBin& bin : quality.radius_histogram) {
    EXPECT_NEAR(bin.to_m / bin.from_m, std::exp2(0.125), 1e-12);
    const auto within = std::count_if(balls.begin(), balls.end(), [&](const Ball& ball) {
      return ball.radius_m >= bin.from_m && ball.radius_m < bin.to_m;
    });
    EXPECT_EQ(static_cast<std::ptrdiff_t>(bin.spheres), within);
    sum += bin.spheres;
  }
  EXPECT_EQ(sum, balls.size());
  EXPECT_GT(quality.radius_histogram.front().spheres, 0u);
  EXPECT_GT(quality.radius_histogram.back().spheres, 0u);
}

TEST(PackingQuality, RefusesInvalidInputByName) {
  const auto message = [](const std::vector<Ball>& balls, const QualityParams& params) -> std::string {
    try {
      (void)MeasurePacking(Cube(0.02), balls, params);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({}, {.samples = 10}), "packing quality: samples: found 10, accepted 1000 … 100000000");
  EXPECT_EQ(message({}, {.surface_samples = 0}),
            "packing quality: surface samples: found 0, accepted 1000 … 10000000");
  const Ball good{.center_m = Vector3(0, 0, 0), .radius_m = 1e-3};
  for (const double radius : {0.0, -1e-3, std::nan(""), 1e9})
    EXPECT_THAT(message({good, {.center_m = Vector3(0, 0, 0), .radius_m = radius}}, {}),
                testing::HasSubstr("ball 1: found radius "));
  EXPECT_THAT(message({{.center_m = Vector3(0, std::nan(""), 0), .radius_m = 1e-3}}, {}),
              testing::HasSubstr("ball 0: found radius 0.001 m at (0, nan, 0) m"));
}

}  // namespace
}  // namespace osteon::simulation
