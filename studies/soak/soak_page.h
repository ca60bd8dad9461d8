#pragma once

#include <span>
#include <string>

#include "studies/soak/soak.h"

namespace osteon::studies {

/// One page: verdict, figures, plots over the simulated time, and the episodes that were not as they should
/// be.
[[nodiscard]] std::string SoakPage(std::span<const EpisodeResult> episodes, const SoakOptions& options);

}  // namespace osteon::studies
