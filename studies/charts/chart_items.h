#pragma once

#include <nlohmann/json.hpp>

#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"

// Converts the measurements of charts to items of a part and back: everything that picture, table, page and
// JSON show, exact to the bit. Reading throws nlohmann::json::exception or std::invalid_argument if an item
// is damaged.

namespace osteon::studies {

[[nodiscard]] nlohmann::json ScalingPointItem(const ScalingPoint& point);
[[nodiscard]] ScalingPoint ScalingPointFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json ScoresItem(const simulation::WorkloadScores& scores);
[[nodiscard]] simulation::WorkloadScores ScoresFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json FiguresItem(const simulation::TimeFigures& figures);
[[nodiscard]] simulation::TimeFigures FiguresFrom(const nlohmann::json& item);

}  // namespace osteon::studies
