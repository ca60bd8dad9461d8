#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Loads the solid of a cell's bone, or its packing, and places it so that its site lies where the cell's
/// configuration wants it. The bone has no balls yet, unless they were loaded.
/// @param[in,out] setup  in: has its configuration; out: has `bone`, `solid`, `bone_warning` and `X_WG` as
/// well
/// @param mesh_instead  replaces the cell's own `bone` or scene
/// The error names the file, and the place in the cell's file that names it.
[[nodiscard]] tl::expected<void, std::string> MakeCellBone(CellSetup& setup,
                                                           const std::optional<MeshChoice>& mesh_instead);

}  // namespace osteon::session
