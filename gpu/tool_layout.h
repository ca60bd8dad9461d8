#pragma once

#include <vector>

#include "gpu/shaders/layout.h"
#include "kinematics/spatial.h"
#include "simulation/tool.h"

namespace osteon::gpu {

/// A tool as the device has it: the balls that cut first, each kind in the tool's order, in groups of 32
/// neighbours with a ball around each. Lengths in metres here.
struct ToolLayout {
  struct Item {
    Vector3 center_T_m;
    double radius_m;
  };
  std::vector<Item> balls;
  std::vector<uint> number;  ///< of each in the tool's own list
  std::size_t cutter_count{0};
  std::vector<ToolGroup> groups;   ///< none holds both kinds
  std::vector<Item> group_bounds;  ///< around the group's balls, radii included

  [[nodiscard]] bool Cuts(const ToolGroup& group) const { return group.first < cutter_count; }
};

[[nodiscard]] ToolLayout LayOutTool(const simulation::Tool& tool);

}  // namespace osteon::gpu
