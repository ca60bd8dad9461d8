#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "studies/tune/tune_study.h"

// Converts the simulations in time to JSON items of a shard's part and back, exact to the bit. Reading throws
// nlohmann::json::exception or std::invalid_argument if an item is damaged.

namespace osteon::studies {

[[nodiscard]] nlohmann::json CheckItem(const TuneCheck& check);
[[nodiscard]] TuneCheck CheckFrom(const nlohmann::json& item);

/// The simulated runs with stiff hands (RunStiffHands) as one item.
[[nodiscard]] nlohmann::json StiffHandsItem(const std::vector<StiffHandRun>& runs);
[[nodiscard]] std::vector<StiffHandRun> StiffHandsFrom(const nlohmann::json& item);

}  // namespace osteon::studies
