#pragma once

#include <optional>
#include <string_view>

namespace osteon::config {

/// Factor from the unit in a key to SI: 1e-3 for "radius_mm", pi/180 for "tilt_deg", 1 for "sphere_count".
/// Empty if the key ends in no known unit. The unit is the longest known unit that follows an underscore at
/// the end of the key, or that is the whole key.
[[nodiscard]] std::optional<double> UnitOf(std::string_view key);

/// The unit at the end of a key: "mm" for "radius_mm". Empty if the key ends in no known unit.
[[nodiscard]] std::string_view UnitEnding(std::string_view key);

}  // namespace osteon::config
