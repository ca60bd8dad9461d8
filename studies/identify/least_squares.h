#pragma once

#include <functional>

#include <Eigen/Core>

namespace osteon::studies {

/// A problem of nonlinear least squares.
struct LeastSquares {
  int parameters{0}, residuals{0};  ///< number of parameters; number of residuals
  /// Computes the residuals r of the parameters p.
  std::function<void(const Eigen::VectorXd& p, Eigen::VectorXd& r)> evaluate;
};

/// A solution; only `parameters` is set if the solver did not converge.
struct LeastSquaresFit {
  bool converged{false};
  Eigen::VectorXd parameters{};
  double cost{0.0};  ///< sum of squared residuals
  /// (J^T J)^-1: the covariance of the parameters if the residuals have variance 1.
  Eigen::MatrixXd covariance{};
};

/// Levenberg-Marquardt (Eigen's, after MINPACK) with a numerical Jacobian.
[[nodiscard]] LeastSquaresFit Solve(const LeastSquares& problem, const Eigen::VectorXd& start);

}  // namespace osteon::studies
