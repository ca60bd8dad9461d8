#pragma once

#include <string>

#include <nlohmann/json.hpp>

// Values of a JSON text that another program wrote. A key that is missing, or whose value has another type,
// gives a value of the caller's; nothing throws.

namespace osteon::base {

/// The value at a key; null where there is none.
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
