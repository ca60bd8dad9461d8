#pragma once

#include <optional>
#include <span>
#include <string>

#include "procedure/assessment/cavity_result.h"
#include "procedure/plan/surgical_plan.h"
#include "session/procedure/session_file.h"

namespace osteon::session {

/// The part of a plan that is left to do. A score does not show it, because its items measure the cut bone.
struct Unfinished {
  std::string text{};     ///< the part that is left, in words; empty: nothing is left
  bool by_a_tool{false};  ///< the reason: every pass of the last tool was undone, or it has none
};

/// A plan's last tool may stop this far above its planned place (assumed).
inline constexpr double kMaxToGo_mm = 1.0;

/// Returns how far the plan's last tool stopped above its planned place, in its deepest pass that was not
/// undone; 0 or negative if it reached the place. Nothing if no such pass has SessionPass::to_go_mm.
[[nodiscard]] std::optional<double> ToGoOfLastTool_mm(const procedure::SurgicalPlan& plan,
                                                      std::span<const SessionPass> passes);

/// Finds what is left of the plan from the passes only: checks whether the last tool has reached its planned
/// depth.
[[nodiscard]] Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan,
                                      std::span<const SessionPass> passes);
/// Finds what is left of the plan from the passes and from the bone that is left in the planned cavity.
[[nodiscard]] Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan,
                                      std::span<const SessionPass> passes,
                                      const procedure::CavityResult& cavity);

}  // namespace osteon::session
