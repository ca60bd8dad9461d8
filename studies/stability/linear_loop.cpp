#include "studies/stability/linear_loop.h"

#include <algorithm>
#include <cmath>

namespace osteon::hil {

Eigen::MatrixXd LoopMatrix(const LoopStep& step, int size) {
  Eigen::MatrixXd loop(size, size);
  for (int i = 0; i < size; ++i) loop.col(i) = step(Eigen::VectorXd::Unit(size, i));
  return loop;
}

double SpectralRadius(const Eigen::MatrixXd& loop) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(loop, false).eigenvalues().cwiseAbs().maxCoeff();
}

double GrowthPerPeriod(const LoopStep& step, int size, int settle, int periods) {
  Eigen::VectorXd state = Eigen::VectorXd::Unit(size, 0);
  const auto run = [&](int count) {
    double log_size = 0.0;
    for (int i = 0; i < count; ++i) {
      state = step(state);
      const double norm = state.norm();
      if (norm == 0.0) return -std::numeric_limits<double>::infinity();  // dead beat: nothing is left
      log_size += std::log(norm);
      state /= norm;
    }
    return log_size;
  };
  run(settle);
  return run(periods) / periods;
}

Boundary FirstCrossing(const std::function<bool(double)>& stable, const BoundaryScan& scan) {
  if (!stable(scan.from)) return {.value = 0.0, .crossed = true};
  double low = scan.from, high = scan.from;
  do {
    low = high;
    if (low >= scan.to) return {.value = scan.to, .crossed = false};
    high = std::min(scan.to, low * scan.factor);
  } while (stable(high));
  while (high - low > scan.tolerance * low) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return {.value = low, .crossed = true};
}

}  // namespace osteon::hil
