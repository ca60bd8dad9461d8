#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "session/planning/plan.h"
#include "session/summary/verdict.h"

namespace osteon::studies {

/// "bad" if a check measured another result than the plan predicts. "look" if the requested error or rate is
/// not met, or if threads waited for a processor in the frames from which the times are predicted.
[[nodiscard]] session::Verdict Judge(const session::FidelityPlan& plan,
                                     const std::optional<session::PlanCheck>& check);

/// JSON of `osteon plan --json`, schema osteon.plan/1, without the verdict.
[[nodiscard]] nlohmann::json PlanJson(const session::PlanScene& scene, const session::PlanRequest& request,
                                      const session::FidelityPlan& plan,
                                      const std::optional<session::PlanCheck>& check);

/// Text for the terminal, with the verdict.
[[nodiscard]] std::string PlanText(const session::PlanScene& scene, const session::PlanRequest& request,
                                   const session::FidelityPlan& plan,
                                   const std::optional<session::PlanCheck>& check);

/// Command line of `osteon plan`.
struct PlanOptions {
  session::PlanChoice choice;
  session::PlanRequest request;
  bool check{false};  ///< true: the planned packing is also made and measured
  std::filesystem::path json;
  std::filesystem::path out{};  ///< folder for plan.html; empty: no page
  std::string command_line{};
};

/// Runs `osteon plan`. @returns the process's exit code: 1 if a demand is not met or a check failed
[[nodiscard]] int RunPlan(const PlanOptions& options);

}  // namespace osteon::studies
