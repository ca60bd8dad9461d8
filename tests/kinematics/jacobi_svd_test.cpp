#include "kinematics/jacobi_svd.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include "tests/base/checked_no_alloc_scope.h"

namespace osteon::kinematics {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

template <int N>
class RandomJacobians {
 public:
  using Jacobian = Eigen::Matrix<double, 6, N>;
  // Entries from the normal distribution.
  Jacobian Next() {
    return Jacobian::NullaryExpr([this] { return normal_(random_); });
  }
  // A random Jacobian with these singular values.
  Jacobian WithSingularValues(const Eigen::Matrix<double, 6, 1>& sigma) {
    const Eigen::JacobiSVD<Jacobian> svd(Next(), Eigen::ComputeFullU | Eigen::ComputeFullV);
    return svd.matrixU() * sigma.asDiagonal() * svd.matrixV().template leftCols<6>().transpose();
  }

 private:
  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
};

// The defining properties of a decomposition; tolerance for rounding of 6 x 7 sums of products of order one.
template <int N>
void ExpectDecomposes(const Eigen::Matrix<double, 6, N>& J, const JacobianSvd<N>& d, double tolerance) {
  EXPECT_LT((d.U.transpose() * d.U - Matrix6::Identity()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((d.V.transpose() * d.V - Eigen::Matrix<double, N, N>::Identity()).cwiseAbs().maxCoeff(), 1e-13);
  const Eigen::Matrix<double, 6, N> product =
      d.U * d.sigma.asDiagonal() * d.V.template leftCols<6>().transpose();
  EXPECT_LT((product - J).cwiseAbs().maxCoeff(), tolerance);
  for (int k = 1; k < 6; ++k) EXPECT_LE(d.sigma[k], d.sigma[k - 1]);
  if constexpr (N > 6) {
    EXPECT_LT((J * d.V.template rightCols<N - 6>()).cwiseAbs().maxCoeff(), tolerance);
  }
}

TEST(JacobiSvd, SingularValuesEqualThoseOfEigen) {
  RandomJacobians<7> seven;
  RandomJacobians<6> six;
  for (int n = 0; n < 2000; ++n) {
    const auto J = seven.Next();
    const auto d = ComputeJacobianSvd<7>(J, Matrix6::Identity());
    ExpectDecomposes<7>(J, d, 1e-13);
    const Eigen::JacobiSVD<Eigen::Matrix<double, 6, 7>> eigen(J);
    EXPECT_LT((d.sigma - eigen.singularValues()).cwiseAbs().maxCoeff(), 1e-13);
    const auto K = six.Next();
    ExpectDecomposes<6>(K, ComputeJacobianSvd<6>(K, Matrix6::Identity()), 1e-13);
    if (HasFailure()) FAIL() << "matrix " << n;
  }
}

// Near a singular posture the small singular values matter. Their absolute error must be as small as that of
// the large ones, even for the value zero.
TEST(JacobiSvd, SmallSingularValuesAreExact) {
  RandomJacobians<7> random;
  for (double least : {1e-3, 1e-6, 1e-9, 1e-12, 0.0}) {
    Eigen::Matrix<double, 6, 1> sigma;
    sigma << 2.0, 1.5, 1.5, 0.3, 0.3, least;
    for (int n = 0; n < 100; ++n) {
      const auto J = random.WithSingularValues(sigma);
      const auto d = ComputeJacobianSvd<7>(J, Matrix6::Identity());
      ExpectDecomposes<7>(J, d, 1e-13);
      EXPECT_LT((d.sigma - sigma).cwiseAbs().maxCoeff(), 3e-15 * 6.0) << "the matrix itself is rounded";
      if (::testing::Test::HasFailure()) FAIL() << "least " << least;
    }
  }
}

TEST(JacobiSvd, DecomposesMatricesOfEveryRank) {
  RandomJacobians<7> random;
  for (int rank = 0; rank < 6; ++rank) {
    Eigen::Matrix<double, 6, 1> sigma = Eigen::Matrix<double, 6, 1>::Ones();
    sigma.tail(6 - rank).setZero();
    const auto J = rank == 0 ? Eigen::Matrix<double, 6, 7>(Eigen::Matrix<double, 6, 7>::Zero())
                             : random.WithSingularValues(sigma);
    ExpectDecomposes<7>(J, ComputeJacobianSvd<7>(J, Matrix6::Identity()), 1e-13);
  }
}

// The previous tick's directions U are a good start: after a millisecond's small change of the Jacobian, less
// than half of the sweeps are needed.
TEST(JacobiSvd, StartFromThePreviousTickSavesSweeps) {
  RandomJacobians<7> random;
  int cold = 0, warm = 0;
  for (int n = 0; n < 200; ++n) {
    const auto J = random.Next();
    const auto d = ComputeJacobianSvd<7>(J, Matrix6::Identity());
    const Eigen::Matrix<double, 6, 7> next = J + 1e-4 * random.Next();
    const auto again = ComputeJacobianSvd<7>(next, d.U);
    ExpectDecomposes<7>(next, again, 1e-13);
    cold += d.sweeps;
    warm += again.sweeps;
  }
  EXPECT_LT(2 * warm, cold) << warm << " sweeps, " << cold << " without";
}

// Each of 200 000 ticks starts from the directions U of the previous tick. The rounding errors must not
// accumulate.
TEST(JacobiSvd, DirectionsPassedFromTickToTickStayOrthogonal) {
  RandomJacobians<7> random;
  auto J = random.Next();
  const Eigen::Matrix<double, 6, 7> drift = 1e-4 * random.Next();
  Matrix6 previous_U = Matrix6::Identity();
  for (int n = 0; n < 200'000; ++n) {
    J += drift * ((n / 20'000) % 2 == 0 ? 1.0 : -1.0);
    previous_U = ComputeJacobianSvd<7>(J, previous_U).U;
  }
  ExpectDecomposes<7>(J, ComputeJacobianSvd<7>(J, previous_U), 1e-11);
}

TEST(JacobiSvd, DoesNotAllocate) {
  RandomJacobians<7> random;
  const auto J = random.Next();
  rt::CheckedNoAllocScope no_alloc;
  const auto d = ComputeJacobianSvd<7>(J, Matrix6::Identity());
  no_alloc.End();
  EXPECT_GT(d.sigma[0], 0.0);
}

}  // namespace
}  // namespace osteon::kinematics
