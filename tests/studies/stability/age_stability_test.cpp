// The bound for forces of any age a: M x'' + D x' + K x(t - a(t)) = 0 is stable if D - a_max K > 0.

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include "tests/oracles/age_bound.h"

namespace osteon::studies {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Simulates that equation in semi-implicit steps of dt, as in the shipped law. In each step the force is that
// of the pose age() samples before; age() is at most `most`. The largest age of K's force is (most + 1) dt,
// because a force is applied for a whole step.
// @returns logarithm of the growth from the second third to the last; negative: the motion decays
template <int N, typename Age>
double LogGrowth(const Eigen::Matrix<double, N, N>& M, const Eigen::Matrix<double, N, N>& D,
                 const Eigen::Matrix<double, N, N>& K, double dt, int steps, int most, Age&& age) {
  using Vector = Eigen::Matrix<double, N, 1>;
  const Eigen::Matrix<double, N, N> inverse = (M + dt * D).inverse();
  std::vector<Vector> past(static_cast<std::size_t>(most) + 1, Vector::Ones());
  Vector x = Vector::Ones(), v = Vector::Zero();
  std::array<double, 3> size{};
  for (int k = 0; k < steps; ++k) {
    past[static_cast<std::size_t>(k % (most + 1))] = x;
    const int old = std::min(age(), k);
    const Vector& aged_x = past[static_cast<std::size_t>((k - old) % (most + 1))];
    v = inverse * (M * v - dt * (K * aged_x));
    x += dt * v;
    size[static_cast<std::size_t>(3LL * k / steps)] += x.squaredNorm();
    if (size[0] > 1e200 || size[1] > 1e200 || size[2] > 1e200) return 1e3;
  }
  return std::log(size[2] / size[1]);
}

// A random symmetric matrix. The logarithms of its eigenvalues are uniformly distributed between those of
// `least` and `most`.
Matrix6 RandomSymmetric(std::mt19937_64& bits, double least, double most) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> spread(std::log(least), std::log(most));
  const Matrix6 any = Matrix6::NullaryExpr([&] { return normal(bits); });
  const Matrix6 Q = Eigen::HouseholderQR<Matrix6>(any).householderQ();
  const Vector6 values = Vector6::NullaryExpr([&] { return std::exp(spread(bits)); });
  return Q * values.asDiagonal() * Q.transpose();
}

// Count of 1000 random systems that grow, with D = factor · a_max K and random ages.
int CountGrowing(double factor) {
  constexpr double kStep_s = 1e-3;
  constexpr int kMax = 9;  // samples: a_max is 10 ms
  int growing = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    std::mt19937_64 bits(seed);
    const Matrix6 M = RandomSymmetric(bits, 0.2, 5.0), K = RandomSymmetric(bits, 200.0, 2000.0);
    const Matrix6 D = factor * (kMax + 1) * kStep_s * K;
    EXPECT_EQ(hil::AgeReserve(D, K, (kMax + 1) * kStep_s) > 0.0, factor > 1.0);
    std::uniform_int_distribution<int> age(0, kMax);
    if (LogGrowth<6>(M, D, K, kStep_s, 6000, kMax, [&] { return age(bits); }) > 0.0) ++growing;
  }
  return growing;
}

// The closed form: only the stiffest direction matters.
TEST(AgeBound, ReserveIsTheLeastDampingLessAgeTimesStiffness) {
  Matrix6 K = 100.0 * Matrix6::Identity();
  K(2, 2) = 2000.0;
  EXPECT_NEAR(hil::AgeReserve(25.0 * Matrix6::Identity(), K, 10e-3), 5.0, 1e-9);
  EXPECT_NEAR(hil::AgeReserve(15.0 * Matrix6::Identity(), K, 10e-3), -5.0, 1e-9);
}

TEST(AgeBound, NoneOf1000RandomSystemsGrowsWithDampingAboveAgeTimesStiffness) {
  EXPECT_EQ(CountGrowing(1.02), 0);
}

TEST(AgeBound, MostOf1000RandomSystemsGrowWithAFifthOfThatDamping) { EXPECT_GT(CountGrowing(0.2), 900); }

// The age is always the largest one, a case that random ages don't cover.
TEST(AgeBound, HoldsForAConstantMaximalAge) {
  std::mt19937_64 bits(7);
  for (int i = 0; i < 50; ++i) {
    const Matrix6 M = RandomSymmetric(bits, 0.2, 5.0), K = RandomSymmetric(bits, 200.0, 2000.0);
    EXPECT_LT(LogGrowth<6>(M, 1.02 * 10e-3 * K, K, 1e-3, 6000, 9, [] { return 9; }), 0.0);
  }
}

// A contact beside the tool's centre, 5 ms old: its stiffness by the bound, and the true limit, which is a
// tenth higher.
TEST(AgeBound, AContactAtALeverHasTheDesignsMaxStiffness) {
  constexpr double kLever_m = 0.15, kLinear = 100.0, kTurning = 0.5, kAge_s = 5e-3;
  const double bound = hil::LeverStiffness(kLever_m, kLinear, kTurning, kAge_s);
  EXPECT_NEAR(bound, 3636.0, 1.0);
  EXPECT_NEAR(hil::LeverStiffness(0.0, kLinear, kTurning, kAge_s), 20e3, 1e-6);
  EXPECT_GE(hil::LeverStiffness(kLever_m, kLinear, kLinear * kLever_m * kLever_m, kAge_s), 0.5 * 20e3 - 1e-6)
      << "b_r = b L^2 keeps half of it";

  // the true limit, in nearly continuous time: steps of 10 us; a tool of 3 kg and 0.03 kg m²
  constexpr double kStep_s = 10e-6;
  const int most = static_cast<int>(std::lround(kAge_s / kStep_s)) - 1;
  const Eigen::Vector2d M(3.0, 0.03), D(kLinear, kTurning), arm(1.0, kLever_m);
  const auto grows = [&](double k) {
    return LogGrowth<2>(M.asDiagonal(), D.asDiagonal(), k * arm * arm.transpose(), kStep_s, 400'000, most,
                        [&] { return most; }) > 0.0;
  };
  EXPECT_FALSE(grows(bound));
  double low = bound, high = 2.0 * bound;
  ASSERT_TRUE(grows(high));
  while (high - low > 1.0) (grows(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  EXPECT_NEAR(low, 4030.0, 0.01 * 4030.0);
}

}  // namespace
}  // namespace osteon::studies
