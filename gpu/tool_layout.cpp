#include "gpu/tool_layout.h"

#include <algorithm>

namespace osteon::gpu {

ToolLayout LayOutTool(const simulation::Tool& tool) {
  ToolLayout layout;
  for (const bool cutting : {true, false}) {
    const std::size_t begin = layout.balls.size();
    for (std::size_t t = 0; t < tool.balls.size(); ++t) {
      if (tool.balls[t].cutting != cutting) continue;
      layout.balls.push_back({.center_T_m = tool.balls[t].center_m, .radius_m = tool.balls[t].radius_m});
      layout.number.push_back(static_cast<uint>(t));
    }
    if (cutting) layout.cutter_count = layout.balls.size();
    for (std::size_t first = begin; first < layout.balls.size(); first += kToolGroup) {
      const std::size_t end = std::min(layout.balls.size(), first + kToolGroup);
      Eigen::AlignedBox3d box;
      for (std::size_t t = first; t < end; ++t) box.extend(layout.balls[t].center_T_m);
      double radius_m = 0.0;
      for (std::size_t t = first; t < end; ++t)
        radius_m =
            std::max(radius_m, (layout.balls[t].center_T_m - box.center()).norm() + layout.balls[t].radius_m);
      layout.groups.push_back({.first = static_cast<uint>(first), .count = static_cast<uint>(end - first)});
      layout.group_bounds.push_back({.center_T_m = box.center(), .radius_m = radius_m});
    }
  }
  return layout;
}

}  // namespace osteon::gpu
