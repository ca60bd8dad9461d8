#pragma once

#include "config/cell_config.h"
#include "config/reader.h"

namespace osteon::config {

/// Section `guard`, beside `fri`: where the arm finds the supervisor.
///
///     guard: {port, [host], [margin_ratio], [silence_ms]}
///
/// Without a host it listens on the loopback. It sends on to the section fri's place, which must be another
/// one. Refuses a cell with rsi: the guard reads FRI alone.
[[nodiscard]] GuardConfig ReadGuard(Reader& cell_section, const ArmLinkConfig& link);

}  // namespace osteon::config
