#pragma once

#include <optional>
#include <span>
#include <string>

#include "procedure/assessment/cavity_result.h"
#include "procedure/plan/surgical_plan.h"
#include "session/procedure/session_file.h"

namespace osteon::session {

/// The part of a plan that is left to do. No score says it, because its items measure what was cut.
struct Unfinished {
  std::string text{};     ///< empty: nothing
  bool by_a_tool{false};  ///< the last tool has no pass that counts
};

/// A plan's last tool may stop this far above its planned place. Assumed.
inline constexpr double kMaxToGo_mm = 1.0;

/// How far the plan's last tool stopped above its planned place, in its deepest pass that counts; nothing
/// where no pass says it. 0 or less: it came there.
[[nodiscard]] std::optional<double> ToGoOfLastTool_mm(const procedure::SurgicalPlan& plan,
                                                      std::span<const SessionPass> passes);

/// By the passes alone: whether the last tool came to its planned depth.
[[nodiscard]] Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan,
                                      std::span<const SessionPass> passes);
/// By the passes, and by what is left of the planned cavity.
[[nodiscard]] Unfinished UnfinishedOf(const procedure::SurgicalPlan& plan,
                                      std::span<const SessionPass> passes,
                                      const procedure::CavityResult& cavity);

}  // namespace osteon::session
