#pragma once

#include <functional>

#include <Eigen/Dense>

// A linear sampled loop, known by its step alone. Its matrix is computed from that step, so every statement
// about its stability holds for the code that runs.

namespace osteon::hil {

/// One period: state in, state out; linear, of the same size.
using LoopStep = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The loop's matrix, size x size: column i is the step's result for unit vector i.
[[nodiscard]] Eigen::MatrixXd LoopMatrix(const LoopStep& step, int size);

/// Largest modulus of the eigenvalues: the loop is stable below 1, and the slowest mode changes by this
/// factor in a period.
[[nodiscard]] double SpectralRadius(const Eigen::MatrixXd& loop);

/// The first unstable value of an upward scan.
struct Boundary {
  double value{0.0};    ///< the crossing; without one, the end of the scan
  bool crossed{false};  ///< false: stable up to the end
};

struct BoundaryScan {
  double from{1.0}, to{1e6};  ///< > 0
  double factor{1.05};     ///< from one value of the scan to the next, > 1: a narrower window of instability
                           ///< may be missed
  double tolerance{1e-4};  ///< relative, of the crossing
};

/// Scans upward to the first crossing, then bisects: stability is not monotone in stiffness, so a bisection
/// over the whole range could end at a crossing that a user never reaches. If `from` is already unstable the
/// value is 0.
[[nodiscard]] Boundary FirstCrossing(const std::function<bool(double)>& stable, const BoundaryScan& scan);

}  // namespace osteon::hil
