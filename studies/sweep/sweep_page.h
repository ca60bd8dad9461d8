#pragma once

#include <string>

#include "studies/sweep/sweep_result.h"

namespace osteon::studies {

/// The page of a whole sweep: quantiles of each combination, distributions, and charts of each figure over
/// each numeric parameter.
[[nodiscard]] std::string SweepPage(const SweepResult& result, const std::string& command_line);

}  // namespace osteon::studies
