#pragma once

#include <nlohmann/json.hpp>

#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"

// What charts measure, as items of a part: everything that picture, table, page and JSON show, to the bit.
// Reading throws nlohmann::json::exception or std::invalid_argument if an item is damaged.

namespace osteon::studies {

[[nodiscard]] nlohmann::json ScalingPointItem(const ScalingPoint& point);
[[nodiscard]] ScalingPoint ScalingPointFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json ScoresItem(const simulation::WorkloadScores& scores);
[[nodiscard]] simulation::WorkloadScores ScoresFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json FiguresItem(const simulation::TimeFigures& figures);
[[nodiscard]] simulation::TimeFigures FiguresFrom(const nlohmann::json& item);

}  // namespace osteon::studies
