#pragma once

#include <functional>

#include <Eigen/Core>

namespace osteon::studies {

/// A problem of nonlinear least squares.
struct LeastSquares {
  int parameters{0}, residuals{0};  ///< their numbers
  /// Computes the residuals r of the parameters p.
  std::function<void(const Eigen::VectorXd& p, Eigen::VectorXd& r)> evaluate;
};

/// A solution; only `parameters` is set if the solver did not converge.
struct LeastSquaresFit {
  bool converged{false};
  Eigen::VectorXd parameters{};
  double cost{0.0};              ///< sum of squared residuals
  Eigen::MatrixXd covariance{};  ///< (J^T J)^-1: of the parameters if the residuals have variance 1
};

/// Levenberg-Marquardt (Eigen's, after MINPACK) with a numerical Jacobian.
[[nodiscard]] LeastSquaresFit Solve(const LeastSquares& problem, const Eigen::VectorXd& start);

}  // namespace osteon::studies
