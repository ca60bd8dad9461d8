#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "studies/failures/failures.h"

namespace osteon::studies {

/// A scenario's outcome as an item of a part: everything that table, page and JSON show, to the bit.
[[nodiscard]] nlohmann::json FailureItem(const FailureRun& run);
/// @throws nlohmann::json::exception or std::invalid_argument if the item is damaged.
[[nodiscard]] FailureRun FailureRunFrom(const nlohmann::json& item);

}  // namespace osteon::studies
