#pragma once

#include <filesystem>

#include "config/reading/cell_config.h"
#include "config/reading/load_surgical_plan.h"

namespace osteon::config {

/// Refuses a plan that cannot be carried out in a cell:
///
/// - The plan's cup differs from the cup of the cell's bone, in centre or radius. This is not checked if the
///   plan is for a mesh of the command line and the cell names no bone: that mesh then replaces the bone of
///   the cell's scene.
/// - The cell's depth limit begins to resist before a reamer reaches its planned depth.
///
/// @param plan_file, cell_file  named in the error
/// @throws ConfigError
void CheckPlanInCell(const SurgicalPlanConfig& plan, const CellConfig& cell,
                     const std::filesystem::path& plan_file, const std::filesystem::path& cell_file);

/// Pose of the bone's own frame in the world. CellConfig::X_WG is the pose of the site's frame C instead,
/// which for a mesh differs from the frame of its file.
/// @param site  the cup in the bone's own frame
[[nodiscard]] Pose BoneInWorld(const CellConfig& cell, const simulation::CutSite& site);

}  // namespace osteon::config
