#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "studies/failures/failures.h"

namespace osteon::studies {

/// Converts a scenario's outcome to a JSON item of a study that is split over machines (studies/sharding).
/// The item has everything that table, page and JSON show, exact to the bit.
[[nodiscard]] nlohmann::json FailureItem(const FailureRun& run);
/// Converts an item back. @throws nlohmann::json::exception or std::invalid_argument if the item is damaged.
[[nodiscard]] FailureRun FailureRunFrom(const nlohmann::json& item);

}  // namespace osteon::studies
