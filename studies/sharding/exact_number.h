#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace osteon::studies {

/// A number as JSON that reads back to the same bits; JSON itself has no infinity.
[[nodiscard]] inline nlohmann::json ExactNumber(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}

/// Reads it back. @throws std::invalid_argument
[[nodiscard]] inline double ExactNumberFrom(const nlohmann::json& json) {
  if (json.is_number()) return json.get<double>();
  if (json == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (json == "inf") return std::numeric_limits<double>::infinity();
  if (json == "-inf") return -std::numeric_limits<double>::infinity();
  throw std::invalid_argument("found " + json.dump() + ", accepted a number");
}

}  // namespace osteon::studies
