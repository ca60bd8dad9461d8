#pragma once

#include "config/reading/strict/reader.h"
#include "hil/injection/wire_faults.h"

namespace osteon::config {

/// Reads a cell's `injections`, a list of faults on wires, and `injection_seed`. Both are optional: without
/// them nothing is injected.
[[nodiscard]] hil::InjectionParams ReadInjections(Reader& cell);

}  // namespace osteon::config
