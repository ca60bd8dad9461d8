#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include <gmock/gmock.h>

#include "simulation/packing/packing_builder.h"
#include "simulation/solids/acetabulum_solid.h"
#include "simulation/solids/mesh_solid.h"
#include "tests/simulation/packing/cover_index.h"

// Tests of overlapping packings with a given number of balls.

namespace osteon::simulation {
namespace {

/// A ball of bone around the origin, whose distances and volume are known exactly.
class RoundSolid final : public Solid {
 public:
  explicit RoundSolid(double radius_m) : radius_m_(radius_m) {}
  SurfacePoint NearestSurface(const Vector3& p_m) const override {
    const double r = p_m.norm();
    return {.p_m = r > 0.0 ? Vector3(p_m * (radius_m_ / r)) : Vector3(radius_m_ * Vector3::UnitX()),
            .distance_m = r - radius_m_};
  }
  MaterialIndex MaterialAt(const Vector3&) const override { return 0; }
  Eigen::AlignedBox3d Bounds() const override {
    return {Vector3::Constant(-radius_m_), Vector3::Constant(radius_m_)};
  }

 private:
  double radius_m_;
};

/// An overlapping packing with these options.
std::vector<Ball> Pack(const Solid& solid, const CutZone& zone, const OverlapOptions& options) {
  return BuildPacking(solid, zone, OverlapParamsFor(solid, zone, options));
}

/// Distance from p to the union of the balls, negative inside; by a loop over all balls.
double GapTo(const std::vector<Ball>& balls, const Vector3& p) {
  double gap = 1.0;
  for (const Ball& ball : balls) gap = std::min(gap, (p - Vector3(ball.center_m)).norm() - ball.radius_m);
  return gap;
}

bool Same(const std::vector<Ball>& a, const std::vector<Ball>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Ball& x, const Ball& y) {
    return Vector3(x.center_m) == Vector3(y.center_m) && x.radius_m == y.radius_m;
  });
}

/// Mean gap between the solid's surface and the balls, and share of the solid's volume that they cover.
struct Cover {
  double gap_mean_m{0.0}, coverage{0.0};
};

/// Measures the cover of a round solid of this radius at random points of its surface and inside it.
Cover Measure(const std::vector<Ball>& balls, double radius_m) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Cover cover;
  constexpr int kPoints = 3000;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3 u = Vector3(normal(random), normal(random), normal(random)).normalized();
    cover.gap_mean_m += std::max(0.0, GapTo(balls, radius_m * u)) / kPoints;
    cover.coverage += (GapTo(balls, radius_m * std::cbrt(uniform(random)) * u) <= 0.0 ? 1.0 : 0.0) / kPoints;
  }
  return cover;
}

constexpr double kRoundRadius_m = 0.020;    // radius of the round solid
constexpr double kMaxBallRadius_m = 0.003;  // largest packed balls

TEST(PackingCount, IsReachedExactly) {
  const RoundSolid round(kRoundRadius_m);
  const AcetabulumSolid cup({});
  const CupZone zone(cup.cup());
  for (const std::size_t count : {1u, 10u, 300u, 4000u}) {
    EXPECT_EQ(Pack(round, EverywhereZone(), {.count = count, .max_radius_m = kMaxBallRadius_m}).size(),
              count);
    EXPECT_EQ(Pack(cup, zone, {.count = count}).size(), count);
    EXPECT_EQ(Pack(cup, zone, {.count = count, .max_radius_m = kMaxBallRadius_m, .grade = 0.3}).size(),
              count);
  }
}

TEST(PackingCount, IsReachedFromDefaultParametersOfAnotherCount) {
  const AcetabulumSolid cup({});
  for (const std::size_t count : {500u, 60'000u}) {
    PackingParams params;
    params.count = count;
    EXPECT_EQ(BuildPacking(cup, CupZone(cup.cup()), params).size(), count);
  }
}

// Oracle: balls of radius r that touch a sphere of radius R from inside leave a gap of x²/2 (1/r - 1/R) at
// the distance x from the nearest point of contact. A hexagonal arrangement has the smallest mean x² that is
// possible: 5/(18√3) of the area for each contact. The packer may be a quarter worse.
TEST(PackingCount, GapsOfASphereAreNearTheHexagonalMinimum) {
  const std::vector<Ball> balls =
      Pack(RoundSolid(kRoundRadius_m), EverywhereZone(), {.count = 8000, .max_radius_m = kMaxBallRadius_m});
  double touching = 0.0;
  for (const Ball& ball : balls)
    touching += kRoundRadius_m - Vector3(ball.center_m).norm() - ball.radius_m < 1e-6 ? 1.0 : 0.0;
  ASSERT_GT(touching, 2000.0);
  const double area = 4.0 * M_PI * kRoundRadius_m * kRoundRadius_m / touching;
  const double best = 5.0 / (36.0 * std::sqrt(3.0)) * area * (1.0 / kMaxBallRadius_m - 1.0 / kRoundRadius_m);
  const double gap = Measure(balls, kRoundRadius_m).gap_mean_m;
  std::printf("%g of %zu balls touch: gap mean %.5f mm, hexagons %.5f\n", touching, balls.size(), gap * 1e3,
              best * 1e3);
  EXPECT_GE(gap, best);
  EXPECT_LE(gap, 1.25 * best);
}

TEST(PackingCount, MoreBallsLeaveSmallerGapsAndCoverMore) {
  Cover last{.gap_mean_m = 1.0, .coverage = 0.0};
  for (const std::size_t count : {250u, 1000u, 4000u}) {
    const Cover cover = Measure(Pack(RoundSolid(kRoundRadius_m), EverywhereZone(),
                                     {.count = count, .max_radius_m = kMaxBallRadius_m}),
                                kRoundRadius_m);
    // gaps are proportional to the area for each contact, which is a quarter each time
    EXPECT_LT(cover.gap_mean_m, 0.4 * last.gap_mean_m) << count;
    EXPECT_GE(cover.coverage, last.coverage) << count;
    last = cover;
  }
  EXPECT_GE(last.coverage, 0.99);  // a gap of 0.05 mm everywhere is 0.75 % of the volume
}

TEST(PackingCount, EqualsBitForBitForAnyNumberOfThreads) {
  const AcetabulumSolid cup({});
  const CupZone zone(cup.cup());
  const auto pack = [&](int threads) {
    return Pack(cup, zone,
                {.count = 3000, .max_radius_m = 2e-3, .grade = 0.5, .seed = 4, .threads = threads});
  };
  const auto fill = [&](int threads) {
    PackingParams params;
    params.threads = threads;
    return BuildPacking(cup, zone, params);
  };
  const std::vector<Ball> packed = pack(1), filled = fill(1);
  for (const int threads : {2, 8}) {
    EXPECT_TRUE(Same(pack(threads), packed)) << threads;
    EXPECT_TRUE(Same(fill(threads), filled)) << threads;
  }
}

TEST(PackingCount, AnotherSeedMovesBallsAndKeepsTheMeanGap) {
  const auto pack = [](std::uint64_t seed) {
    return Pack(RoundSolid(kRoundRadius_m), EverywhereZone(),
                {.count = 2000, .max_radius_m = kMaxBallRadius_m, .seed = seed});
  };
  const std::vector<Ball> one = pack(1), two = pack(2);
  EXPECT_FALSE(Same(one, two));
  EXPECT_TRUE(Same(one, pack(1)));
  const double gap = Measure(one, kRoundRadius_m).gap_mean_m;
  EXPECT_NEAR(Measure(two, kRoundRadius_m).gap_mean_m, gap, 0.1 * gap);
}

TEST(PackingCount, BallsKeepInsideTheSolidAndWithinTheirRadiusLimits) {
  const AcetabulumSolid cup({});
  const CupZone zone(cup.cup());
  for (const double grade : {0.0, 0.2, 1.0}) {
    const OverlapOptions options{.count = 6000, .min_radius_m = 0.4e-3, .max_radius_m = 2e-3, .grade = grade};
    double largest = 0.0;
    for (const Ball& ball : Pack(cup, zone, options)) {
      const Vector3 c = ball.center_m;
      ASSERT_LE(cup.SignedDistance(c) + ball.radius_m, 1e-12);
      ASSERT_GE(ball.radius_m, options.min_radius_m);
      ASSERT_LE(ball.radius_m, options.max_radius_m + grade * std::max(0.0, zone.DepthAt(c)) + 1e-15);
      largest = std::max(largest, ball.radius_m);
    }
    // the bone below the cup has room for balls of 18 mm, 20 mm deep
    if (grade > 0.0) {
      EXPECT_GT(largest, 4e-3) << grade;
    }
  }
}

TEST(PackingCount, RefusesOptionsOutOfRangeByName) {
  const auto message = [](const OverlapOptions& options) -> std::string {
    try {
      return std::to_string(Pack(RoundSolid(kRoundRadius_m), EverywhereZone(), options).size());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  EXPECT_EQ(message({.count = 10, .max_radius_m = -1e-3}),
            "overlapping packing: greatest radius: found -1 mm, accepted 0.05 … 500 mm");
  EXPECT_EQ(message({.count = 10, .min_radius_m = 4e-3, .max_radius_m = 3e-3}),
            "overlapping packing: least radius: found 4 mm, accepted 0.001 … 3 mm");
  EXPECT_EQ(message({.count = 10, .grade = 1.5}), "overlapping packing: grade: found 1.5, accepted 0 … 1");
  EXPECT_THAT(message({.count = 10, .grade = std::nan("")}), testing::HasSubstr("grade: found nan"));
  EXPECT_EQ(message({.count = 100'000'001}), "packing: count: found 100000001, accepted 0 … 100000000");
}

// Oracle: a loop over all balls.
TEST(CoverIndex, GapIsTheDistanceToTheUnionOfBalls) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] {
    return Vector3(0.01 * Vector3(uniform(random), uniform(random), uniform(random)));
  };
  const Eigen::AlignedBox3d box(Vector3::Constant(-0.01), Vector3::Constant(0.01));
  const double margin = 2e-3;
  CoverIndex index(box, 0.7e-3, margin);
  std::vector<Ball> balls;
  for (int i = 0; i < 150; ++i) {
    balls.push_back({.center_m = point(), .radius_m = 1.5e-3 * (1.2 + uniform(random))});
    index.Insert(balls.back());
  }
  int outside = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 p = 1.15 * point();  // some beyond the box
    const double expected = std::min(margin, GapTo(balls, p));
    outside += expected > 0.0 ? 1 : 0;
    if (expected > 0.0) {
      ASSERT_NEAR(index.Gap(p), expected, 1e-15);
    } else {
      ASSERT_LE(index.Gap(p), 0.0);
    }
    ASSERT_EQ(index.Covers(p, 0.5e-3), expected <= 0.5e-3);
  }
  EXPECT_GT(outside, 500);
  EXPECT_LT(outside, 4500);
}

// The requirement is that 25 000 balls cover 0.985 of the bone and leave a mean gap of 0.15 mm; 5000 balls do
// better.
TEST(PackingCount, FiveThousandBallsCoverTheHipBone) {
  const char* folder = std::getenv("OSTEON_DATA_DIR");
  const auto path = std::filesystem::path(folder ? folder : "") / "hip_bone_left.obj";
  if (!folder || !std::filesystem::exists(path)) GTEST_SKIP() << "no anatomical meshes";
  const auto loaded = LoadMesh(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const TriangleMesh& mesh = loaded->mesh;
  const MeshSolid solid(mesh);
  const std::vector<Ball> balls = Pack(solid, EverywhereZone(), {.count = 5000});
  EXPECT_EQ(balls.size(), 5000u);
  CoverIndex index(solid.Bounds(), 2e-3, 3e-3);
  for (const Ball& ball : balls) {
    index.Insert(ball);
    ASSERT_LE(solid.SignedDistance(ball.center_m) + ball.radius_m, 1e-12);
  }
  double area = 0.0, gaps = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices_m[t[0]], &b = mesh.vertices_m[t[1]], &c = mesh.vertices_m[t[2]];
    const double weight = (b - a).cross(c - a).norm();
    area += weight;
    gaps += weight * std::max(0.0, index.Gap((a + b + c) / 3.0));
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int inside = 0, covered = 0;
  while (inside < 10'000) {
    const Vector3 u(uniform(random), uniform(random), uniform(random));
    const Vector3 p = solid.Bounds().min() + solid.Bounds().sizes().cwiseProduct(u);
    if (solid.SignedDistance(p) >= 0.0) continue;
    ++inside;
    covered += index.Covers(p, 0.0) ? 1 : 0;
  }
  std::printf("hip bone, 5000 balls: gap mean %.4f mm, coverage %.4f\n", gaps / area * 1e3, covered / 1e4);
  EXPECT_LE(gaps / area, 0.07e-3);
  EXPECT_GE(covered, 9900);
}

}  // namespace
}  // namespace osteon::simulation
