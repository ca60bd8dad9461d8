#include "control/loop/tool_table.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "control/arm/arm_follower.h"

namespace osteon::control {

void RequirePose(const Pose& X, const char* name) {
  const bool is_rotation = (X.linear() * X.linear().transpose() - Matrix3::Identity()).norm() < 1e-6 &&
                           X.linear().determinant() > 0.0;
  if (!X.matrix().allFinite() || !is_rotation)
    throw std::invalid_argument(std::string(name) + ": accepted a finite position and a rotation");
}

void ToolTable::Set(std::vector<LoopTool> tools, int index, const ServoParams& params) {
  if (tools.empty() || tools.size() > static_cast<std::size_t>(kMaxLoopTools))
    throw std::invalid_argument("tools: found " + std::to_string(tools.size()) + ", accepted 1 … " +
                                std::to_string(kMaxLoopTools));
  if (index < 0 || index >= static_cast<int>(tools.size()))
    throw std::invalid_argument("tools: found the index " + std::to_string(index) + ", accepted 0 … " +
                                std::to_string(tools.size() - 1));
  for (const LoopTool& tool : tools) {
    RequirePose(tool.X_FT, "tools: X_FT");
    Validate(tool.sensor);
    if (tool.bending) Validate(*tool.bending);
  }
  std::vector<std::optional<Guidance>> guidances(tools.size());
  for (std::size_t i = 0; i < tools.size(); ++i)
    if (tools[i].guidance)
      guidances[i].emplace(*tools[i].guidance, params.twist.max_speed_m_per_s, params.period_s);
  tools_ = std::move(tools);
  guidances_ = std::move(guidances);
  index_ = index;
}

Pose ToolTable::Select(int index) OSTEON_RT {
  const Pose X_TN = tool().X_FT.inverse() * tools_[static_cast<std::size_t>(index)].X_FT;
  index_ = index;
  return X_TN;
}

}  // namespace osteon::control
