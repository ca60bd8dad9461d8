#pragma once

#include <filesystem>
#include <optional>

#include <string>
#include "session/setup/cell_setup.h"

namespace osteon::studies {

/// Options of `osteon surgical-plan`.
struct SurgicalPlanOptions {
  std::filesystem::path plan;                 ///< file of the plan
  std::filesystem::path cell;                 ///< the plan is also checked against this cell; empty: none
  std::optional<session::MeshChoice> mesh{};  ///< mesh of a plan that states only the cup in a mesh
  std::filesystem::path json;                 ///< a copy of the result; empty: none
};

/// Runs the subcommand `surgical-plan`: checks a plan, and prints its axis in all definitions, its volume and
/// the wall that it leaves. JSON: schema osteon.surgical_plan/1. @returns the process's exit code.
/// @throws config::ConfigError
[[nodiscard]] int RunSurgicalPlan(const SurgicalPlanOptions& options);

}  // namespace osteon::studies
