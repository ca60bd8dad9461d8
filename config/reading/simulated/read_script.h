#pragma once

#include "config/reading/strict/reader.h"
#include "hil/operator/scripts.h"

namespace osteon::config {

/// Reads a section `script`; its `kind` determines the keys: reaming, drilling or opening. Site, tool and
/// hand stay at their defaults.
[[nodiscard]] hil::ScriptParams ReadScript(Reader section);

/// Refuses, at the section's line, a script whose values do not fit its tool and hand.
/// @param hand  the section that contains the hand's max_force_N
void CheckScript(const Reader& section, const hil::ScriptParams& script, const Reader& hand,
                 double hand_max_force_N);

}  // namespace osteon::config
