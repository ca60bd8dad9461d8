#pragma once

#include <nlohmann/json.hpp>

#include "studies/regress/regress.h"

namespace osteon::studies {

/// A scenario's outcome as a JSON item of a part file (studies/sharding): everything that table, page, JSON
/// and JUnit show, exact to the bit.
[[nodiscard]] nlohmann::json RegressItem(const RegressResult& result);
/// Restores a result from its item; the golden trace is read from its file again.
/// @throws nlohmann::json::exception or std::invalid_argument if the item is damaged.
[[nodiscard]] RegressResult RegressResultFrom(const nlohmann::json& item,
                                              const config::ScenarioConfig& scenario);

}  // namespace osteon::studies
