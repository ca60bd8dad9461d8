#pragma once

#include "config/reader.h"
#include "hil/injection/wire_faults.h"

namespace osteon::config {

/// A cell's `injections`, a list of faults on wires, and `injection_seed`. Neither need be there: then
/// nothing is injected.
[[nodiscard]] hil::InjectionParams ReadInjections(Reader& cell);

}  // namespace osteon::config
