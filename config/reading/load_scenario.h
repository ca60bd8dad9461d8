#pragma once

#include "config/reading/scenario_config.h"

namespace osteon::config {

/// Reads a scenario's own keys: `overrides` is applied only when the cell is read (Overlay::SetFromFile).
///
///     shows: the reamer meets bone, enters it and comes out again
///     cell: ../cells/demo.yaml
///     engine: reference          # plane, reference, vulkan
///     duration_s: 2
///     sample_ms: 20
///     recovery_count: 1          # this and the following keys are optional
///     pause_s: 0.8
///     resume_s: 1.2
///     plan: acetabulum           # the loop uses this plan's guidance
///     guidance_ratio: 0.5
///     tolerances: {force_N: 0.05}
///     overrides:
///       scene.packing.spacing_mm: 3
///
/// @throws ConfigError
[[nodiscard]] ScenarioConfig LoadScenario(const std::filesystem::path& file);

}  // namespace osteon::config
