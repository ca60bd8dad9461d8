#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace osteon::base {

/// Formats a JSON value as a file's text: two spaces per level, a newline at the end. Bytes that are not
/// UTF-8 (a file name may have any) become U+FFFD.
template <class Json>
[[nodiscard]] std::string JsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace osteon::base
