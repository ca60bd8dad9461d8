#pragma once

#include <span>
#include <string>

#include "studies/soak/soak.h"

namespace osteon::studies {

/// One HTML page: verdict with every episode's errors, plots over the simulated time, and a count of the
/// episodes of each kind.
[[nodiscard]] std::string SoakPage(std::span<const EpisodeResult> episodes, const SoakOptions& options);

}  // namespace osteon::studies
