#pragma once

#include <filesystem>

#include "config/reading/cell_config.h"
#include "config/reading/load_surgical_plan.h"

namespace osteon::config {

/// Refuses a plan that a cell would hinder: its depth limit begins to resist above the planned depth of a
/// reamer. Also refuses a plan for another scene or bone than the cell's. A plan for a mesh that the command
/// names is for any cell whose bone that mesh replaces.
/// @param plan_file, cell_file  for the error
/// @throws ConfigError
void CheckPlanInCell(const SurgicalPlanConfig& plan, const CellConfig& cell,
                     const std::filesystem::path& plan_file, const std::filesystem::path& cell_file);

/// X_WG of a cell for places of the bone's own frame. (CellConfig::X_WG is the pose of the site's frame C,
/// which differs from the bone's where that is a mesh.)
[[nodiscard]] Pose BoneInWorld(const CellConfig& cell, const simulation::CutSite& site);

}  // namespace osteon::config
