#include "session/procedure/tool_depths.h"

namespace osteon::session {

ToolDepths::ToolDepths(const simulation::Bone& bone, std::span<const ProcedureTool> tools, const Pose& X_WG)
    : X_GW_(X_WG.inverse()) {
  for (const ProcedureTool& tool : tools) depths_.emplace_back(bone, tool.tool);
}

double ToolDepths::At(int tool, const Pose& X_WT) const {
  return depths_[static_cast<std::size_t>(tool) % depths_.size()].DepthAt(X_GW_ * X_WT);
}

}  // namespace osteon::session
