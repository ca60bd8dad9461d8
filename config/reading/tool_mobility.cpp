#include "config/reading/tool_mobility.h"

#include "kinematics/serial_chain.h"

namespace osteon::config {

std::optional<Matrix3> ToolMobility(const CellConfig& cell) {
  const LbrConfig* lbr = cell.robot.lbr();
  if (lbr == nullptr || !lbr->chain.has_masses) return std::nullopt;
  const kinematics::SerialChain<7> chain(lbr->chain);
  const Vector3 p_B = chain.FlangePose(cell.start.q) * cell.tool.X_FT.translation();
  return Matrix3(chain.Mobility(cell.start.q, p_B).topLeftCorner<3, 3>());
}

}  // namespace osteon::config
