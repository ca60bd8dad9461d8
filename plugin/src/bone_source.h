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
  std::shared_ptr<const simulation::Solid> solid;  ///< that it was packed from; null where it is not known
  simulation::SceneEventParams events;
  std::string warning{};  ///< what was assumed of a mesh that bounds no solid, one line; empty: nothing
};

/// Content of an OsteonTool; never changes.
struct ToolSource {
  simulation::Tool tool;
  std::optional<simulation::ToolCompliance> compliance{};  ///< how it bends; absent: it counts as rigid
  double relaxation_s{0.0};                                ///< time constant of its bending
  double spindle_rad_per_s{0.0};
};

/// @throws Failure and what Guarded() knows.
[[nodiscard]] BoneSource MakeBone(const OsteonBoneParams& params);
[[nodiscard]] ToolSource MakeTool(const OsteonToolParams& params);

}  // namespace osteon::plugin
