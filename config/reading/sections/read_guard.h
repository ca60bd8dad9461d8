#pragma once

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Reads section `guard`, beside `fri`: the address at which the arm finds the supervisor.
///
///     guard: {port, [host], [margin_ratio], [silence_ms]}
///
/// Without a host it listens on the loopback. It relays to the address in section fri, which must be another
/// one. Refuses a cell with rsi: the guard reads only FRI.
[[nodiscard]] GuardConfig ReadGuard(Reader& cell_section, const ArmLinkConfig& link);

}  // namespace osteon::config
