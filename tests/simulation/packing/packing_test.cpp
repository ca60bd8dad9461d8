#include "simulation/packing/packing_builder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

#include "simulation/packing/morton.h"
#include "simulation/solids/acetabulum_solid.h"

// Tests of the overlapping packing of the default acetabulum: its number of balls, its gaps before and after
// a cut, and the packing's parameters.

namespace osteon::simulation {
namespace {

constexpr double kCupRadius_m = 0.024;

/// Distance from p to the union of the balls, 0 inside; tests all balls, without an index.
double Gap(const std::vector<Ball>& balls, const Vector3& p) {
  double gap = 1.0;
  for (const Ball& ball : balls) gap = std::min(gap, (p - Vector3(ball.center_m)).norm() - ball.radius_m);
  return std::max(0.0, gap);
}

/// Mean, 95th percentile and maximum of values given in metres.
struct Spread {
  double mean_mm, p95_mm, max_mm;
};

Spread Summarize(std::vector<double> values_m) {
  std::sort(values_m.begin(), values_m.end());
  const double sum = std::accumulate(values_m.begin(), values_m.end(), 0.0);
  return {sum / static_cast<double>(values_m.size()) * 1e3, values_m[values_m.size() * 95 / 100] * 1e3,
          values_m.back() * 1e3};
}

/// The packing of the default block of 80 × 80 × 60 mm with a cup in its top.
class Packing : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    balls_ = BuildPacking(AcetabulumSolid{{}}, CupZone{AcetabulumSolid{{}}.cup()}, {});
  }
  /// A direction uniform on the lower half of the unit sphere.
  Vector3 Downwards() {
    Vector3 u = Vector3(normal_(random_), normal_(random_), normal_(random_)).normalized();
    u.z() = -std::abs(u.z());
    return u;
  }
  inline static std::vector<Ball> balls_;
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

TEST_F(Packing, HasAboutThirtyThousandBalls) {
  EXPECT_GE(balls_.size(), 28'000u);
  EXPECT_LE(balls_.size(), 32'000u);
}

TEST_F(Packing, StaysInsideTheBone) {
  for (const Ball& ball : balls_) {
    const Vector3 c = ball.center_m;
    const double room = std::min(
        {0.04 - std::abs(c.x()), 0.04 - std::abs(c.y()), -c.z(), c.z() + 0.06, c.norm() - kCupRadius_m});
    ASSERT_LE(ball.radius_m, room + 1e-15);
    ASSERT_GE(ball.radius_m, PackingParams{}.min_radius_m);
  }
}

TEST_F(Packing, BallsWithinFourMillimetresOfTheCupAreSmall) {
  for (const Ball& ball : balls_) {
    const double min_depth = Vector3(ball.center_m).norm() - kCupRadius_m - ball.radius_m;
    ASSERT_TRUE(ball.radius_m <= 3e-3 || min_depth >= 4e-3 - 1e-15) << ball.radius_m << " at " << min_depth;
  }
}

TEST_F(Packing, FollowsTheCupsSurfaceWithinHundredthsOfAMillimetre) {
  std::vector<double> gaps;
  for (int i = 0; i < 4000; ++i) gaps.push_back(Gap(balls_, kCupRadius_m * Downwards()));
  const Spread gap = Summarize(gaps);
  std::printf("cup surface: gap mean %.4f, p95 %.4f, max %.4f mm; %zu balls\n", gap.mean_mm, gap.p95_mm,
              gap.max_mm, balls_.size());
  EXPECT_LE(gap.mean_mm, 0.017);
  EXPECT_LE(gap.p95_mm, 0.042);
  EXPECT_LE(gap.max_mm, 0.30);  // the largest gap is at the rim, a sharp edge that balls cannot fill
}

TEST_F(Packing, FollowsTheRimWhereAReamerTouchesFirst) {
  std::vector<double> gaps;
  for (int i = 0; i < 2000; ++i) {
    const double around = 2.0 * M_PI * uniform_(random_), radius = kCupRadius_m + 4e-3 * uniform_(random_);
    gaps.push_back(Gap(balls_, {radius * std::cos(around), radius * std::sin(around), 0.0}));
  }
  EXPECT_LE(Summarize(gaps).p95_mm, 0.055);
}

// Up to 8 mm below the cup no point may be uncovered; elsewhere points may lie up to 1 mm from the balls, and
// 0.1 % of the points deeper than 1 mm may be uncovered.
TEST_F(Packing, HasNoHolesNearTheCupAndOnlySmallOnesElsewhere) {
  const AcetabulumSolid solid{{}};
  int deep = 0, deep_covered = 0;
  for (int i = 0; i < 8000; ++i) {
    const Vector3 below_cup = (kCupRadius_m + 0.0003 + 0.008 * uniform_(random_)) * Downwards();
    if (solid.SignedDistance(below_cup) < -0.3e-3) {
      ASSERT_EQ(Gap(balls_, below_cup), 0.0) << below_cup.transpose();
    }
    const Vector3 anywhere(0.08 * uniform_(random_) - 0.04, 0.08 * uniform_(random_) - 0.04,
                           -0.06 * uniform_(random_));
    if (solid.SignedDistance(anywhere) >= 0.0) continue;
    const double gap = Gap(balls_, anywhere);
    ASSERT_LE(gap, 1e-3) << anywhere.transpose();
    if (solid.SignedDistance(anywhere) > -1e-3) continue;
    ++deep;
    deep_covered += gap == 0.0 ? 1 : 0;
  }
  EXPECT_GE(deep_covered, 0.999 * deep);
}

// The purpose of overlapping balls is that little bone is lost beyond the tool's sweep. A reamer of diameter
// 50 mm goes in along the axis; each ball that it meets shrinks to the largest ball inside the old one and
// outside the sweep (docs/theory/removal.md).
TEST_F(Packing, LosesLittleBoneBeyondAReamersSweep) {
  const double reamer = 0.025;
  for (const double depth : {0.5e-3, 2e-3, 4e-3}) {
    std::vector<Ball> left;
    for (const Ball& ball : balls_) {
      const Vector3 c = ball.center_m;
      const Vector3 away = c - Vector3(0, 0, std::max(c.z(), -depth));
      const double p = ball.radius_m + reamer - away.norm();
      if (p >= 2.0 * ball.radius_m) continue;
      if (p <= 0.0)
        left.push_back(ball);
      else
        left.push_back(
            {.center_m = Vector3(c + 0.5 * p * away.normalized()), .radius_m = ball.radius_m - 0.5 * p});
    }
    std::vector<double> gaps;
    for (int i = 0; i < 2000; ++i) gaps.push_back(Gap(left, reamer * Downwards() - Vector3(0, 0, depth)));
    const Spread gap = Summarize(gaps);
    std::printf("cut %.1f mm: lost beyond the sweep mean %.4f, p95 %.4f mm\n", depth * 1e3, gap.mean_mm,
                gap.p95_mm);
    EXPECT_LE(gap.mean_mm, 0.024);
    EXPECT_LE(gap.p95_mm, 0.06);
  }
}

TEST_F(Packing, IsTheSameInEachRunAndInMortonOrder) {
  const AcetabulumSolid solid{{}};
  const std::vector<Ball> again = BuildPacking(solid, CupZone{solid.cup()}, {});
  ASSERT_EQ(again.size(), balls_.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    ASSERT_EQ(Vector3(again[i].center_m), Vector3(balls_[i].center_m));
    ASSERT_EQ(again[i].radius_m, balls_[i].radius_m);
    if (i > 0) {
      ASSERT_LE(MortonCode(balls_[i - 1].center_m, solid.Bounds()),
                MortonCode(balls_[i].center_m, solid.Bounds()));
    }
  }
}

TEST_F(Packing, RefusesParametersOutOfRangeByName) {
  const auto message = [](const PackingParams& params) -> std::string {
    try {
      return std::to_string(
          BuildPacking(AcetabulumSolid{{}}, CupZone{AcetabulumSolid{{}}.cup()}, params).size());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  PackingParams params;
  params.lattice.finest_m = -1e-3;
  EXPECT_EQ(message(params), "packing: lattice: finest side: found -1 mm, accepted 0.02 … 500 mm");
  params = {};
  params.lattice.coarser_from_m = {12e-3, 6e-3};
  EXPECT_EQ(message(params), "packing: lattice: depth of level 2: found 6 mm, accepted 12 … 1000 mm");
  params = {};
  params.surface_gap_m = 0.0;
  EXPECT_THAT(message(params), testing::HasSubstr("surface gap: found 0 mm"));
}

// Interleaved by hand for x = 1, y = 2, z = 3. The box has 2^21 cells along each axis.
TEST(MortonCode, InterleavesBitsWithXLowest) {
  const double cells = 2097152.0;
  const Eigen::AlignedBox3d box(Vector3(0, 0, 0), Vector3(cells, cells, cells));
  EXPECT_EQ(MortonCode({1, 2, 3}, box), 0b110'101u);
  EXPECT_EQ(MortonCode({cells, cells, cells}, box), 0x7fffffffffffffffu);
  EXPECT_EQ(MortonCode({-5, 0, 0}, box), 0u);
}

}  // namespace
}  // namespace osteon::simulation
