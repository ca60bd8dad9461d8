#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace osteon::app {

/// A JSON value as a file's text: two spaces a level, a newline at the end. JSON is UTF-8: bytes that are
/// not (a file's name may be any) become U+FFFD.
template <class Json>
[[nodiscard]] std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace osteon::app
