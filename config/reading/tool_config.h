#pragma once

#include <optional>

#include "kinematics/spatial.h"
#include "simulation/tools/tool.h"
#include "simulation/tools/tool_compliance.h"

namespace osteon::config {

/// The motor that turns a tool.
struct ToolDriveConfig {
  double gear_ratio{1.0};  ///< turns of the motor for each turn of the tool
  double rated_torque_Nm{0.0};
  double spin_up_s{0.0};  ///< time from rest to the spindle's speed
};

/// How a tool bends.
struct ToolBendingConfig {
  simulation::ToolCompliance compliance;  ///< compliance of the tool without thrust
  double relaxation_s{0.020};             ///< time constant of the bending in the loop
};

struct ToolConfig {
  simulation::Tool tool;
  Pose X_FT{Pose::Identity()};                 ///< tool in the flange's frame
  std::optional<ToolBendingConfig> bending{};  ///< absent: the tool is rigid
  double spindle_rad_per_s{0.0};
  ToolDriveConfig drive;
};

}  // namespace osteon::config
