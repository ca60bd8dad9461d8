#pragma once

#include <functional>

#include <Eigen/Dense>

// Analysis of a linear sampled loop that is given only by the code of one step. The loop's matrix is computed
// by calling this code, so results on stability hold for the code itself.

namespace osteon::hil {

/// Computes the loop's state after one period from its present state. Linear; both states have the same size.
using LoopStep = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The loop's matrix, size x size: column i is the step's result for unit vector i.
[[nodiscard]] Eigen::MatrixXd LoopMatrix(const LoopStep& step, int size);

/// Largest modulus of the eigenvalues: below 1 the loop is stable, and the slowest mode changes by this
/// factor in a period.
[[nodiscard]] double SpectralRadius(const Eigen::MatrixXd& loop);

/// The boundary of stability that an upward scan finds.
struct Boundary {
  double value{0.0};  ///< value at which the loop becomes unstable; without such a value, the end of the scan
  bool crossed{false};  ///< false: stable up to the end of the scan
};

struct BoundaryScan {
  double from{1.0}, to{1e6};  ///< > 0
  /// Ratio of successive values of the scan, > 1; a narrower range of instability may be missed.
  double factor{1.05};
  double tolerance{1e-4};  ///< relative tolerance of the boundary
};

/// Scans upward to the first unstable value, then bisects. A bisection of the whole range could end at a
/// higher boundary, because stability is not monotone in stiffness. If `from` is already unstable, the
/// result's value is 0.
[[nodiscard]] Boundary FirstCrossing(const std::function<bool(double)>& stable, const BoundaryScan& scan);

}  // namespace osteon::hil
