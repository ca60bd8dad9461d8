#include "gpu/engine/tool_layout.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace osteon::gpu {
namespace {

// Box around the centres of these balls [m, T].
Eigen::AlignedBox3d BoxOf(const ToolLayout& layout, std::span<const uint> members) {
  Eigen::AlignedBox3d box;
  for (const uint t : members) box.extend(layout.balls[t].center_T_m);
  return box;
}

// Halves the members along the longest side of their box until a group has at most kToolGroup balls, and adds
// the groups to the layout.
void AddGroups(ToolLayout& layout, std::span<uint> members) {
  if (members.empty()) return;
  const Eigen::AlignedBox3d box = BoxOf(layout, members);
  if (members.size() > kToolGroup) {
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto half = static_cast<std::ptrdiff_t>(members.size() / 2);
    std::nth_element(members.begin(), members.begin() + half, members.end(), [&](uint a, uint b) {
      const double x = layout.balls[a].center_T_m[axis], y = layout.balls[b].center_T_m[axis];
      return x < y || (x == y && a < b);
    });
    AddGroups(layout, members.first(static_cast<std::size_t>(half)));
    AddGroups(layout, members.subspan(static_cast<std::size_t>(half)));
    return;
  }
  double radius_m = 0.0;
  for (const uint t : members) {
    radius_m =
        std::max(radius_m, (layout.balls[t].center_T_m - box.center()).norm() + layout.balls[t].radius_m);
    layout.group_of[t] = static_cast<uint>(layout.groups.size());
  }
  layout.groups.emplace_back(members.begin(), members.end());
  layout.group_bounds.push_back({.center_T_m = box.center(), .radius_m = radius_m});
}

}  // namespace

ToolLayout LayOutTool(const simulation::Tool& tool) {
  ToolLayout layout;
  for (const bool cutting : {true, false}) {
    for (std::size_t t = 0; t < tool.balls.size(); ++t) {
      if (tool.balls[t].cutting != cutting) continue;
      layout.balls.push_back({.center_T_m = tool.balls[t].center_m, .radius_m = tool.balls[t].radius_m});
      layout.number.push_back(static_cast<uint>(t));
    }
    if (cutting) layout.cutter_count = layout.balls.size();
  }
  layout.group_of.resize(layout.balls.size());
  std::vector<uint> order(layout.balls.size());
  std::iota(order.begin(), order.end(), 0u);
  AddGroups(layout, std::span(order).first(layout.cutter_count));
  AddGroups(layout, std::span(order).subspan(layout.cutter_count));
  return layout;
}

}  // namespace osteon::gpu
