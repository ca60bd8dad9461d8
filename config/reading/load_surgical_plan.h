#pragma once

#include <filesystem>
#include <optional>

#include "config/reading/cell_config.h"
#include "procedure/plan/surgical_plan.h"

namespace osteon::config {

/// A surgical plan with the bone that it is made for.
struct SurgicalPlanConfig {
  procedure::SurgicalPlan plan;
  simulation::SceneParams scene;   ///< without its materials
  std::optional<BoneConfig> bone;  ///< absent: the scene's own solid
  /// The cup of a mesh that the plan is for and does not name: the command does. Absent: another bone.
  std::optional<simulation::CutSite> mesh_cup;
  simulation::CutSite site;  ///< of that bone, in G
};

/// Loads a plan and the scene that it names. Refuses an axis that is more than 45 degrees off the scene's
/// cup, diameters that do not rise, and gains beyond what the guidance is known to be stable with.
/// @throws ConfigError
[[nodiscard]] SurgicalPlanConfig LoadSurgicalPlan(const std::filesystem::path& path);

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
