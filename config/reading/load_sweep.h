#pragma once

#include "config/reading/sweep_config.h"

namespace osteon::config {

/// Reads a sweep.
///
///     shows: a trembling hand on couplings of three dampings
///     scenario: tremor            # under scenarios/, or a file
///     seed_count: 8               # draws of each combination of listed values
///     parameters:
///       - key: coupling.damping_Ns_per_m
///         takes: 50, 100, 200              # each of them; or: 50 to 200 in 4 steps
///       - key: operator.tremor_N
///         takes: uniform 0 to 4           # or: normal 2 sd 0.5
///       - key: operator.tremor_seed
///         takes: seed                     # 1 … seed_count
///
/// @throws ConfigError
[[nodiscard]] SweepConfig LoadSweep(const std::filesystem::path& file);

}  // namespace osteon::config
