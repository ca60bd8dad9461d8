#pragma once

#include "config/reader.h"
#include "hil/scripts.h"

namespace osteon::config {

/// A section `script`, whose `kind` says which keys it has: reaming, drilling or opening. Where the site and
/// the tool are, and the hand that follows, stay the defaults.
[[nodiscard]] hil::ScriptParams ReadScript(Reader section);

/// What the values of a script, with its tool and hand, would be refused for: at the section's line.
/// @param hand  the section that says the hand's max_force_N
void CheckScript(const Reader& section, const hil::ScriptParams& script, const Reader& hand,
                 double hand_max_force_N);

}  // namespace osteon::config
