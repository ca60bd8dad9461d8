#pragma once

#include <filesystem>

#include "procedure/assessment/score.h"

namespace osteon::config {

/// Loads a rubric: one section for each scored metric (procedure::Metrics), its norms in the metric's unit,
/// each with its source; and what is deducted.
/// @throws ConfigError
[[nodiscard]] procedure::Rubric LoadRubric(const std::filesystem::path& path);

}  // namespace osteon::config
