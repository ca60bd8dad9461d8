#pragma once

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Reads section `guard`, beside `fri`: the address at which the guard receives the arm's messages.
///
///     guard: {port, [host], [margin_ratio], [silence_ms]}
///
/// Without a host, the guard listens on the loopback. It relays to the address in section `fri`, which must
/// differ from its own. Refuses a cell with rsi: the guard reads only FRI.
[[nodiscard]] GuardConfig ReadGuard(Reader& cell_section, const ArmLinkConfig& link);

}  // namespace osteon::config
