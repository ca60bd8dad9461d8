#pragma once

#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "control/guidance/guidance_field.h"
#include "kinematics/spatial.h"
#include "procedure/plan/surgical_plan.h"
#include "simulation/tools/tool.h"

// Converts a surgical plan into the guidance of the servo loop.

namespace osteon::session {

/// Makes the guidance of one tool of a plan for the loop; nothing if the plan has no guidance.
/// @param X_WG  the bone's frame in the world
/// @throws std::invalid_argument if a gain is outside its accepted range (control::Validate).
[[nodiscard]] std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                                const procedure::PlannedTool& tool,
                                                                const Pose& X_WG);
/// Makes the guidance of the plan's reamer whose diameter is that of the tool's cutting head.
/// @throws std::invalid_argument if the plan has no such reamer.
[[nodiscard]] std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                                const simulation::Tool& tool,
                                                                const Pose& X_WG);

/// Makes the JSON that a recording keeps; GuidanceFromJson returns the same bits.
[[nodiscard]] nlohmann::json ToJson(const control::GuidanceParams& guidance);
/// Reads the guidance from a recording's JSON. @throws nlohmann::json::exception, std::invalid_argument
[[nodiscard]] control::GuidanceParams GuidanceFromJson(const nlohmann::json& json);

}  // namespace osteon::session
