#pragma once

#include "config/reading/strict/reader.h"
#include "hil/operator/scripts.h"

namespace osteon::config {

/// Reads a section `script`; its `kind` determines the keys: reaming, drilling or opening. The script's
/// values of site, tool and hand keep their defaults; LoadCell sets them later.
[[nodiscard]] hil::ScriptParams ReadScript(Reader section);

/// Refuses a script whose values do not fit its tool and hand. The error names the section's line.
/// @param hand  the section that contains the hand's max_force_N
void CheckScript(const Reader& section, const hil::ScriptParams& script, const Reader& hand,
                 double hand_max_force_N);

}  // namespace osteon::config
