#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone/material.h"

namespace osteon::config {

/// Selects materials by their names. The result is in the order of the names.
/// @returns the materials, or as the error the first name that is not in `found`
[[nodiscard]] tl::expected<std::vector<simulation::Material>, std::string> SelectMaterials(
    const std::vector<simulation::Material>& found, const std::vector<std::string>& names);

}  // namespace osteon::config
