#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/reading/sweep_config.h"

namespace osteon::studies {

/// One run of a sweep.
struct SweepRun {
  std::size_t index{0};
  std::size_t combination{0};         ///< index of the combination of the listed values
  int seed{1};                        ///< number of the seed, 1 … SweepConfig::seeds
  std::vector<std::string> values{};  ///< one value for each parameter
};

/// Returns the run with an index. Successive runs differ first in the seed, then in the last listed
/// parameter. A drawn value depends only on the parameter's key and the seed. So it is the same on every
/// machine, in every shard and for every combination, and combinations are compared with the same drawn
/// values.
[[nodiscard]] SweepRun SweepRunAt(const config::SweepConfig& sweep, std::size_t index);

/// The run's values as assignments, "coupling.stiffness_N_per_mm=10", in the form that `regress --set`
/// accepts.
[[nodiscard]] std::vector<std::string> AssignmentsOf(const config::SweepConfig& sweep, const SweepRun& run);

/// Returns indices of runs that together contain each listed value at least once. These runs are checked
/// before any run begins.
[[nodiscard]] std::vector<std::size_t> RunsWithEachValue(const config::SweepConfig& sweep);

}  // namespace osteon::studies
