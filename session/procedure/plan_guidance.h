#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/tools/tool.h"

// From a surgical plan to the guidance of the servo loop.

namespace osteon::session {

/// The guidance of one tool of a plan, as the loop needs it; absent: the plan has none.
/// @param X_WG  the bone's frame in the world
/// @throws std::invalid_argument if a gain is beyond what is accepted (control::Validate).
[[nodiscard]] std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                                const procedure::PlannedTool& tool,
                                                                const Pose& X_WG);
/// The guidance of the plan's reamer that a tool is, by the diameter of its cutting head.
/// @throws std::invalid_argument if the plan has no such reamer.
[[nodiscard]] std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                                const simulation::Tool& tool,
                                                                const Pose& X_WG);

/// As a recording keeps it; GuidanceFromJson returns the same bits.
[[nodiscard]] nlohmann::json ToJson(const control::GuidanceParams& guidance);
/// @throws nlohmann::json::exception, std::invalid_argument
[[nodiscard]] control::GuidanceParams GuidanceFromJson(const nlohmann::json& json);

}  // namespace osteon::session
