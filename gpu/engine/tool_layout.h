#pragma once

#include <vector>

#include "gpu/shaders/layout.h"
#include "kinematics/spatial.h"
#include "simulation/tools/tool.h"

namespace osteon::gpu {

inline constexpr std::size_t kToolGroup = 16;  ///< largest number of tool balls in one bounding ball

/// A tool's balls in the device's order: cutting balls first, then the others, each kind in the order of the
/// tool's own list. The balls are also grouped by neighbourhood; each group has a bounding ball, for the
/// host's search. Lengths in metres, in T.
struct ToolLayout {
  struct Item {
    Vector3 center_T_m;
    double radius_m;
  };
  std::vector<Item> balls;
  std::vector<uint> number;  ///< each ball's index in the tool's own list
  std::size_t cutter_count{0};
  std::vector<std::vector<uint>> groups;  ///< indices into `balls`; no group holds both kinds
  std::vector<Item> group_bounds;         ///< bounding ball of each group's balls
  std::vector<uint> group_of;             ///< the group of each ball

  [[nodiscard]] bool Cuts(std::size_t ball) const { return ball < cutter_count; }
};

[[nodiscard]] ToolLayout LayOutTool(const simulation::Tool& tool);

}  // namespace osteon::gpu
