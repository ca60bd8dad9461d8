#pragma once

#include <string>

#include <nlohmann/json.hpp>

// Reads values from JSON that another program wrote. If a key is missing, or its value has another type, the
// functions return the argument `otherwise`. They do not throw.

namespace osteon::base {

/// Returns the value at a key; a JSON null if there is none.
template <class Json>
[[nodiscard]] const Json& ValueAt(const Json& json, const char* key) {
  static const Json kNull;
  if (!json.is_object()) return kNull;
  const auto at = json.find(key);
  return at == json.end() ? kNull : *at;
}

template <class Json>
[[nodiscard]] std::string TextAt(const Json& json, const char* key, const char* otherwise = "") {
  const Json& value = ValueAt(json, key);
  return value.is_string() ? value.template get<std::string>() : otherwise;
}

template <class Json>
[[nodiscard]] double NumberAt(const Json& json, const char* key, double otherwise = 0.0) {
  const Json& value = ValueAt(json, key);
  return value.is_number() ? value.template get<double>() : otherwise;
}

template <class Json>
[[nodiscard]] bool FlagAt(const Json& json, const char* key, bool otherwise = false) {
  const Json& value = ValueAt(json, key);
  return value.is_boolean() ? value.template get<bool>() : otherwise;
}

}  // namespace osteon::base
