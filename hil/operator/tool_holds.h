#pragma once

#include <vector>

#include "hil/operator/hand_script.h"

namespace osteon::hil {

/// A time in which the hand holds a retracted tool, so that it can be changed.
struct ToolHold {
  double begin_s{0.0}, length_s{0.0};  ///< since the script began
};

/// The holds after each tool but the last.
/// @param script  of MakeProcedureScript
[[nodiscard]] std::vector<ToolHold> HoldsForChanges(const HandScript& script);

}  // namespace osteon::hil
