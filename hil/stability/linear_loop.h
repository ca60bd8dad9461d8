#pragma once

#include <functional>

#include <Eigen/Dense>

// A sampled loop that is linear, known by its step alone. Its matrix comes from that step, so whatever is
// said of its stability is said of the code that runs.

namespace osteon::hil {

/// One period: state in, state out; linear, the size the same.
using LoopStep = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

/// The loop's matrix, size x size: column i is what the step makes of unit vector i.
[[nodiscard]] Eigen::MatrixXd LoopMatrix(const LoopStep& step, int size);

/// Largest modulus of the eigenvalues: the loop is stable below 1, and its slowest mode changes by this a
/// period.
[[nodiscard]] double SpectralRadius(const Eigen::MatrixXd& loop);

/// Natural logarithm of the growth a period, by running the loop: the mean over `periods`, after `settle` of
/// them in which every mode but the slowest dies out. Normalised as it goes, so neither growth nor decay runs
/// out of numbers.
[[nodiscard]] double GrowthPerPeriod(const LoopStep& step, int size, int settle, int periods);

/// Where a scan upward meets the first unstable value.
struct Boundary {
  double value{0.0};    ///< the crossing; where there is none, the end of the scan
  bool crossed{false};  ///< false: stable up to the end
};

struct BoundaryScan {
  double from{1.0}, to{1e6};  ///< > 0
  double factor{1.05};     ///< from one value of the scan to the next, > 1: a window of instability narrower
                           ///< than this may be missed
  double tolerance{1e-4};  ///< relative, of the crossing
};

/// Scans upward to the first crossing, then bisects: stability is not monotone in stiffness, so a bisection
/// over the whole range could end at a crossing behind which a user never gets. Where `from` is unstable
/// already the value is 0.
[[nodiscard]] Boundary FirstCrossing(const std::function<bool(double)>& stable, const BoundaryScan& scan);

}  // namespace osteon::hil
