#pragma once

#include <optional>

#include "control/compliance/compliant_link.h"
#include "control/guidance/guidance_field.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The servo loop's data of one tool: an entry of the table that a change of tool selects from. All entries
/// are prepared before the run.
struct LoopTool {
  Pose X_FT{Pose::Identity()};  ///< tool on the flange
  ForceSensorParams sensor;     ///< with the load on its tool side
  /// The arm with this tool as payload, as ServoParams::arm_body; absent: the payload stays.
  std::optional<kinematics::ChainParams<7>> arm_body{};
  std::optional<GuidanceParams> guidance{};  ///< along the plan, for this tool; absent: none
  std::optional<ToolLinkParams> bending{};   ///< used if the cell's tool is compliant; absent: rigid
};

/// Largest number of tools in a loop's table.
inline constexpr int kMaxLoopTools = 32;

}  // namespace osteon::control
