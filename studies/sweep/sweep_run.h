#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "config/reading/sweep_config.h"

namespace osteon::studies {

/// One run of a sweep.
struct SweepRun {
  std::size_t index{0};
  std::size_t combination{0};         ///< index of the combination of listed values
  int seed{1};                        ///< 1 … SweepConfig::seeds
  std::vector<std::string> values{};  ///< one for each parameter
};

/// The run with an index: seeds run fastest, then the last listed parameter. A drawn value depends on its key
/// and the seed alone, so it is the same on every machine, in every shard, and at every combination:
/// combinations are compared on the same draws.
[[nodiscard]] SweepRun SweepRunAt(const config::SweepConfig& sweep, std::size_t index);

/// The run's values as assignments "coupling.stiffness_N_per_mm=10", as `regress --set` accepts them.
[[nodiscard]] std::vector<std::string> AssignmentsOf(const config::SweepConfig& sweep, const SweepRun& run);

/// Returns runs that together contain each listed value at least once. They are checked before any run
/// begins.
[[nodiscard]] std::vector<std::size_t> RunsWithEachValue(const config::SweepConfig& sweep);

}  // namespace osteon::studies
