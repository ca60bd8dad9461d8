#pragma once

#include <span>
#include <string>

#include "studies/soak/soak.h"

namespace osteon::studies {

/// One HTML page: the verdict with all errors of episodes, plots over the simulated time, and the number of
/// episodes of each kind.
[[nodiscard]] std::string SoakPage(std::span<const EpisodeResult> episodes, const SoakOptions& options);

}  // namespace osteon::studies
