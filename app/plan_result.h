#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "app/plan.h"
#include "app/verdict.h"

namespace osteon::app {

/// Bad where a check measured something else than was promised; to be looked at where error or rate were
/// given up, or where threads waited for a processor in frames that the predicted times come from.
[[nodiscard]] Verdict Judge(const FidelityPlan& plan, const std::optional<PlanCheck>& check);

/// What `osteon plan --json` writes: schema osteon.plan/1; the verdict is not in it.
[[nodiscard]] nlohmann::json PlanJson(const PlanScene& scene, const PlanRequest& request,
                                      const FidelityPlan& plan, const std::optional<PlanCheck>& check);

/// The same for the terminal, the verdict included.
[[nodiscard]] std::string PlanText(const PlanScene& scene, const PlanRequest& request,
                                   const FidelityPlan& plan, const std::optional<PlanCheck>& check);

}  // namespace osteon::app
