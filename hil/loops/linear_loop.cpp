#include "hil/loops/linear_loop.h"

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
