#pragma once

#include <memory>
#include <optional>
#include <string>

#include "plugin/include/osteon.h"
#include "simulation/bone/bone.h"
#include "simulation/bone/scene_events.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_compliance.h"

namespace osteon::plugin {

/// Content of an OsteonBone; never changes.
struct BoneSource {
  simulation::Bone bone;
  std::shared_ptr<const simulation::Solid> solid;  ///< from which the bone was packed; null: unknown
  simulation::SceneEventParams events;
  std::string warning{};  ///< assumptions made about a mesh that bounds no solid, one line; empty: none
};

/// Content of an OsteonTool; never changes.
struct ToolSource {
  simulation::Tool tool;
  std::optional<simulation::ToolCompliance> compliance{};  ///< how it bends; absent: it counts as rigid
  double relaxation_s{0.0};                                ///< time constant of its bending
  double spindle_rad_per_s{0.0};
};

/// @throws Failure, or another exception that Guarded() turns into a code.
[[nodiscard]] BoneSource MakeBone(const OsteonBoneParams& params);
[[nodiscard]] ToolSource MakeTool(const OsteonToolParams& params);

}  // namespace osteon::plugin
