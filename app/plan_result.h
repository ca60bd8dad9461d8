#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "app/plan.h"

namespace osteon::app {

/// What `osteon plan --json` writes: schema osteon.plan/1.
[[nodiscard]] nlohmann::json PlanJson(const PlanScene& scene, const PlanRequest& request,
                                      const FidelityPlan& plan, const std::optional<PlanCheck>& check);

/// The same for the terminal.
[[nodiscard]] std::string PlanText(const PlanScene& scene, const PlanRequest& request,
                                   const FidelityPlan& plan, const std::optional<PlanCheck>& check);

}  // namespace osteon::app
