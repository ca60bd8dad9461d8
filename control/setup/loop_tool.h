#pragma once

#include <optional>

#include "control/compliance/compliant_link.h"
#include "control/guidance/guidance_field.h"
#include "control/sensing/hand_wrench.h"
#include "kinematics/chain_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The servo loop's data of one tool: one entry of the loop's table of tools. A change of tool selects an
/// entry during the run. All entries are prepared before the run.
struct LoopTool {
  Pose X_FT{Pose::Identity()};  ///< tool on the flange
  ForceSensorParams sensor;     ///< includes this tool's load, which the sensor carries
  /// Model of the arm with this tool as payload; replaces ServoParams::arm_body. Absent: the loop keeps its
  /// present model.
  std::optional<kinematics::ChainParams<7>> arm_body{};
  /// Guidance along the surgical plan with this tool; absent: none.
  std::optional<GuidanceParams> guidance{};
  std::optional<ToolLinkParams> bending{};  ///< used if the cell's tool is compliant; absent: rigid
};

/// Largest number of tools in a loop's table.
inline constexpr int kMaxLoopTools = 32;

}  // namespace osteon::control
