#pragma once

#include <nlohmann/json.hpp>

#include "studies/charts/chart_scaling.h"
#include "studies/charts/chart_speed_accuracy.h"

// Converts the measurements of charts to JSON items and back, exact to the bit. A study that is split over
// machines (studies/sharding) stores its items in the file of each part. An item has everything that the
// chart's picture, table, page and JSON show. Reading a damaged item throws nlohmann::json::exception or
// std::invalid_argument.

namespace osteon::studies {

[[nodiscard]] nlohmann::json ScalingPointItem(const ScalingPoint& point);
[[nodiscard]] ScalingPoint ScalingPointFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json ScoresItem(const simulation::WorkloadScores& scores);
[[nodiscard]] simulation::WorkloadScores ScoresFrom(const nlohmann::json& item);

[[nodiscard]] nlohmann::json FiguresItem(const simulation::TimeFigures& figures);
[[nodiscard]] simulation::TimeFigures FiguresFrom(const nlohmann::json& item);

}  // namespace osteon::studies
