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
  std::shared_ptr<const simulation::Solid> solid;  ///< solid from which the bone was packed; null: unknown
  simulation::SceneEventParams events;
  /// one line with the assumptions made for a mesh that does not bound a solid; empty: none
  std::string warning{};
};

/// Content of an OsteonTool; never changes.
struct ToolSource {
  simulation::Tool tool;
  /// how the tool bends; absent: the tool is treated as rigid
  std::optional<simulation::ToolCompliance> compliance{};
  double relaxation_s{0.0};  ///< time constant of its bending
  double spindle_rad_per_s{0.0};
};

/// Makes a bone from a caller's parameters. @throws Failure, or another exception that Guarded() turns into a
/// code.
[[nodiscard]] BoneSource MakeBone(const OsteonBoneParams& params);
[[nodiscard]] ToolSource MakeTool(const OsteonToolParams& params);

}  // namespace osteon::plugin
