#pragma once

#include <filesystem>
#include <optional>

#include "config/reading/bone_config.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/bone/scenes.h"

namespace osteon::config {

/// A surgical plan with the bone that it is made for.
struct SurgicalPlanConfig {
  procedure::SurgicalPlan plan;
  simulation::SceneParams scene;   ///< without its materials
  std::optional<BoneConfig> bone;  ///< absent: the scene's own solid
  /// The cup, if the plan is for a mesh that only the command line names. Absent: the bone is that of `bone`
  /// or `scene`.
  std::optional<simulation::CutSite> mesh_cup;
  simulation::CutSite site;  ///< site of the plan's bone, in G
};

/// Loads a plan and the scene that it names. Refuses an axis that deviates by more than 45 degrees from the
/// axis of the bone's cup, diameters that do not rise, and gains beyond those with which the guidance is
/// known to be stable.
/// @throws ConfigError
[[nodiscard]] SurgicalPlanConfig LoadSurgicalPlan(const std::filesystem::path& path);

}  // namespace osteon::config
