#pragma once

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Sets up a cell for a test. Its bone is packed by the scene's own `packing`, which does not depend on the
/// machine.
[[nodiscard]] inline tl::expected<CellSetup, std::string> SetUpCell(
    const std::filesystem::path& cell_yaml, const std::optional<MeshChoice>& mesh,
    const std::optional<config::ToolChoice>& tool = {}, const std::filesystem::path& gains = {}) {
  auto setup = PrepareCell(cell_yaml, mesh, tool, gains);
  if (setup) PackAsScene(*setup);
  return setup;
}

}  // namespace osteon::session
