#pragma once

#include <cmath>
#include <limits>

#include "hil/loops/linear_loop.h"

// Stability found by running a loop: an oracle of the spectral radius of the loop's matrix. Exact to about
// 1/periods.

namespace osteon::studies {

/// Natural logarithm of the state's growth per period, found by running the loop. It is the mean over
/// `periods`, after `settle` periods in which all modes but the slowest die out. The state is normalised
/// repeatedly, so that it neither overflows nor underflows.
[[nodiscard]] inline double GrowthPerPeriod(const hil::LoopStep& step, int size, int settle, int periods) {
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

}  // namespace osteon::studies
