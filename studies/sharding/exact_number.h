#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace osteon::studies {

/// Converts a number to JSON that reads back to the same bits, also if the number is not finite, which JSON
/// itself cannot express.
[[nodiscard]] inline nlohmann::json ExactNumber(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}

/// Reads a number that ExactNumber made. @throws std::invalid_argument
[[nodiscard]] inline double ExactNumberFrom(const nlohmann::json& json) {
  if (json.is_number()) return json.get<double>();
  if (json == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (json == "inf") return std::numeric_limits<double>::infinity();
  if (json == "-inf") return -std::numeric_limits<double>::infinity();
  throw std::invalid_argument("found " + json.dump() + ", accepted a number");
}

/// Whether ExactNumberFrom accepts the value.
[[nodiscard]] inline bool IsExactNumber(const nlohmann::json& json) {
  return json.is_number() || json == "nan" || json == "inf" || json == "-inf";
}

/// Reads `json[key]` into `to`. Accepts only a value that the type of `to` holds: true or false, a whole
/// number (from 0 on if the type is unsigned), a number, a text, a list of numbers or texts.
/// @throws std::invalid_argument naming key, value and what is accepted
template <class T>
void ReadAt(const nlohmann::json& json, const char* key, T& to) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  const auto refuse = [&](const char* accepted) {
    const std::string found =
        at == json.end() ? "nothing" : at->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    throw std::invalid_argument(std::string(key) + ": found " + found.substr(0, 60) + ", accepted " +
                                accepted);
  };
  if (at == json.end()) return refuse("a value");
  if constexpr (std::is_same_v<T, bool>) {
    if (!at->is_boolean()) return refuse("true or false");
  } else if constexpr (std::is_unsigned_v<T>) {
    const bool is_negative = !at->is_number_unsigned() && at->is_number() && at->template get<double>() < 0.0;
    if (!at->is_number_integer() || is_negative || !std::in_range<T>(at->template get<std::uint64_t>()))
      return refuse("a whole number from 0 on");
  } else if constexpr (std::is_integral_v<T>) {
    if (!at->is_number_integer() || !std::in_range<T>(at->template get<std::int64_t>()))
      return refuse("a whole number");
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!at->is_string()) return refuse("a text");
  } else if constexpr (std::is_same_v<T, std::vector<std::string>>) {
    if (!at->is_array() || !std::ranges::all_of(*at, [](const auto& each) { return each.is_string(); }))
      return refuse("a list of texts");
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    if (!at->is_array() || !std::ranges::all_of(*at, IsExactNumber)) return refuse("a list of numbers");
    to.clear();
    for (const nlohmann::json& each : *at) to.push_back(ExactNumberFrom(each));
    return;
  } else {
    static_assert(std::is_same_v<T, double>);
    if (!IsExactNumber(*at)) return refuse("a number");
    to = ExactNumberFrom(*at);
    return;
  }
  at->get_to(to);
}

}  // namespace osteon::studies
