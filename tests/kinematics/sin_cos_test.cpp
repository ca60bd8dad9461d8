#include "kinematics/sin_cos.h"

#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace osteon::kinematics {
namespace {

// Largest error of sine and cosine over random angles in ±range_rad.
double WorstError(double range_rad, int count, std::mt19937_64& random) {
  std::uniform_real_distribution<double> in(-range_rad, range_rad);
  double worst = 0.0;
  for (int n = 0; n < count; ++n) {
    const double a = in(random), b = in(random);
    const SinCosN<2> found = SinCos(std::array<double, 2>{a, b});
    for (int i = 0; i < 2; ++i) {
      const long double x = i == 0 ? a : b;
      const auto at = static_cast<std::size_t>(i);
      worst = std::max({worst, static_cast<double>(std::abs(found.sin[at] - std::sin(x))),
                        static_cast<double>(std::abs(found.cos[at] - std::cos(x)))});
    }
  }
  return worst;
}

// The results are compared with the C library's extended precision. Half an ulp of a result near 1 is 2^-54;
// the rounding of the remainder adds as much, the polynomials a little.
TEST(SinCos, EqualsExtendedPrecisionToTheLastPlaces) {
  std::mt19937_64 random{1};
  const double ulp = std::numeric_limits<double>::epsilon();
  EXPECT_LT(WorstError(std::numbers::pi, 400'000, random), ulp);
  EXPECT_LT(WorstError(1e-3, 10'000, random), ulp);
  EXPECT_LT(WorstError(100.0, 100'000, random), ulp);
  EXPECT_LT(WorstError(1e5, 100'000, random), ulp);
  EXPECT_LT(WorstError(1e9, 1'000, random), ulp);  // the C library computes beyond 1e5 rad
}

TEST(SinCos, IsExactAtZeroSineIsOddAndCosineIsEven) {
  const SinCosN<4> zero = SinCos(std::array<double, 4>{0.0, 1.25, -1.25, -0.0});
  EXPECT_EQ(zero.sin[0], 0.0);
  EXPECT_EQ(zero.cos[0], 1.0);
  EXPECT_EQ(zero.sin[1], -zero.sin[2]);
  EXPECT_EQ(zero.cos[1], zero.cos[2]);
}

// Every multiple of an eighth of a turn, and values beside it. Quadrants meet at the odd multiples.
TEST(SinCos, KeepsItsSignsAcrossTheQuadrants) {
  for (int k = -12; k <= 12; ++k)
    for (const double off : {-1e-9, 0.0, 1e-9}) {
      const double x = k * std::numbers::pi / 4.0 + off;
      const SinCosN<2> found = SinCos(std::array<double, 2>{x, -x});
      EXPECT_NEAR(found.sin[0], std::sin(x), 2.5e-16) << x;
      EXPECT_NEAR(found.cos[0], std::cos(x), 2.5e-16) << x;
      EXPECT_NEAR(found.sin[1], -std::sin(x), 2.5e-16) << x;
      EXPECT_NEAR(found.cos[1], std::cos(x), 2.5e-16) << x;
    }
}

TEST(SinCos, IsNanForAnAngleThatIsNotFinite) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const SinCosN<4> found = SinCos(std::array<double, 4>{inf, nan, -inf, 0.5});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_TRUE(std::isnan(found.sin[i]) && std::isnan(found.cos[i]));
  EXPECT_NEAR(found.sin[3], std::sin(0.5), 2.5e-16);
}

}  // namespace
}  // namespace osteon::kinematics
