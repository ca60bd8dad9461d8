#pragma once

#include <filesystem>
#include <optional>

#include <string>
#include "session/setup/cell_setup.h"

namespace osteon::studies {

/// Options of `osteon surgical-plan`.
struct SurgicalPlanOptions {
  std::filesystem::path plan;                 ///< file of the plan
  std::filesystem::path cell;                 ///< cell against which the plan is checked, too; empty: none
  std::optional<session::MeshChoice> mesh{};  ///< mesh for a plan that only states where the cup is in a mesh
  std::filesystem::path json;                 ///< file for a copy of the result; empty: none
};

/// Runs the subcommand `surgical-plan`: checks a plan, and prints its axis by all definitions, its volume,
/// and the thinnest wall of bone that it leaves. JSON: schema osteon.surgical_plan/1. @returns the process's
/// exit code.
/// @throws config::ConfigError
[[nodiscard]] int RunSurgicalPlan(const SurgicalPlanOptions& options);

}  // namespace osteon::studies
