#pragma once

#include <filesystem>

#include "procedure/assessment/score.h"

namespace osteon::config {

/// Loads a rubric. It has a section for each scored metric (procedure::Metrics) with the values for full and
/// for no points, in the metric's unit and with their source, and a section with the deductions.
/// @throws ConfigError
[[nodiscard]] procedure::Rubric LoadRubric(const std::filesystem::path& path);

}  // namespace osteon::config
