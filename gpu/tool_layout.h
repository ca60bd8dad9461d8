#pragma once

#include <vector>

#include "gpu/shaders/layout.h"
#include "kinematics/spatial.h"
#include "simulation/tool.h"

namespace osteon::gpu {

inline constexpr std::size_t kToolGroup = 16;  ///< tool balls of one bounding ball, at most

/// A tool as the device has it: the balls that cut first, each kind in the tool's order; and groups of
/// neighbours, each with a ball around it, for what the host looks for. Lengths in metres here.
struct ToolLayout {
  struct Item {
    Vector3 center_T_m;
    double radius_m;
  };
  std::vector<Item> balls;
  std::vector<uint> number;  ///< of each in the tool's own list
  std::size_t cutter_count{0};
  std::vector<std::vector<uint>> groups;  ///< of balls by their place in `balls`; none holds both kinds
  std::vector<Item> group_bounds;         ///< around the group's balls, radii included
  std::vector<uint> group_of;             ///< each ball's

  [[nodiscard]] bool Cuts(std::size_t ball) const { return ball < cutter_count; }
};

[[nodiscard]] ToolLayout LayOutTool(const simulation::Tool& tool);

}  // namespace osteon::gpu
