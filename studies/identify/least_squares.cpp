#include "studies/identify/least_squares.h"

#include <Eigen/QR>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

namespace osteon::studies {
namespace {

// The problem in the form that Eigen's solver takes. Values that are not finite end the solver's run.
struct Functor {
  using Scalar = double;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;

  const LeastSquares& problem;
  [[nodiscard]] int inputs() const { return problem.parameters; }
  [[nodiscard]] int values() const { return problem.residuals; }
  int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& r) const {
    problem.evaluate(p, r);
    return r.allFinite() ? 0 : -1;
  }
};

}  // namespace

LeastSquaresFit Solve(const LeastSquares& problem, const Eigen::VectorXd& start) {
  using Diff = Eigen::NumericalDiff<Functor, Eigen::Central>;
  const Functor functor{problem};
  Diff diff(functor);
  Eigen::LevenbergMarquardt<Diff> solver(diff);
  solver.parameters.maxfev = 2000;
  solver.parameters.xtol = solver.parameters.ftol = 1e-12;
  LeastSquaresFit fit{.parameters = start};
  const auto status = solver.minimize(fit.parameters);
  using namespace Eigen::LevenbergMarquardtSpace;
  fit.converged = fit.parameters.allFinite() && status != ImproperInputParameters && status != UserAsked &&
                  status != TooManyFunctionEvaluation;
  if (!fit.converged) return fit;
  Eigen::VectorXd r(problem.residuals);
  problem.evaluate(fit.parameters, r);
  fit.cost = r.squaredNorm();
  Eigen::MatrixXd J(problem.residuals, problem.parameters);
  diff.df(fit.parameters, J);
  const Eigen::MatrixXd normal = J.transpose() * J;
  fit.covariance = normal.completeOrthogonalDecomposition().pseudoInverse();
  return fit;
}

}  // namespace osteon::studies
