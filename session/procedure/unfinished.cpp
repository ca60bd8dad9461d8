#include "session/procedure/unfinished.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

namespace osteon::session {
namespace {

// If more than this fraction of the planned cavity is left, the plan is not finished.
constexpr double kMaxShareLeft = 0.5;

// Whether a pass was made with the plan's last tool and was not undone.
bool CountsForLastTool(const procedure::SurgicalPlan& plan, const SessionPass& pass) {
  return !pass.undone && pass.tool_index == static_cast<int>(plan.tools.size()) - 1;
}

// Says how much of the planned cavity is left, if that is more than kMaxShareLeft; else empty.
std::string LeftOf(const procedure::CavityResult& cavity) {
  const double planned_m3 = cavity.PlannedVolume_m3();
  if (!(cavity.under_m3 > kMaxShareLeft * planned_m3)) return "";
  return fmt::format("of the planned cavity {:.0f} of {:.0f} mm³ are left: the last tool is not at its depth",
                     1e9 * cavity.under_m3, 1e9 * planned_m3);
}

}  // namespace

std::optional<double> ToGoOfLastTool_mm(const procedure::SurgicalPlan& plan,
                                        std::span<const SessionPass> passes) {
  std::optional<double> to_go_mm;
  for (const SessionPass& pass : passes)
    if (CountsForLastTool(plan, pass) && pass.to_go_mm)
      to_go_mm = std::min(to_go_mm.value_or(*pass.to_go_mm), *pass.to_go_mm);
  return to_go_mm;
}

Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan, std::span<const SessionPass> passes) {
  const std::optional<double> to_go_mm = ToGoOfLastTool_mm(plan, passes);
  if (std::ranges::none_of(passes, [&](const auto& pass) { return CountsForLastTool(plan, pass); }))
    return {
        .text = fmt::format("no pass of its last tool, {:g} mm, counts", 1e3 * plan.tools.back().diameter_m),
        .by_a_tool = true};
  if (!to_go_mm)
    return {.text = "how far its last tool went is not in session.json (`to_go_mm`; an older session)"};
  if (*to_go_mm <= kMaxToGo_mm) return {};
  return {.text = fmt::format("its last tool stopped {:.1f} mm short of its planned depth, accepted {:g} mm",
                              *to_go_mm, kMaxToGo_mm)};
}

Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan, std::span<const SessionPass> passes,
                        const procedure::CavityResult& cavity) {
  Unfinished unfinished = UnfinishedOf(plan, passes);
  if (unfinished.text.empty()) unfinished.text = LeftOf(cavity);
  return unfinished;
}

}  // namespace osteon::session
