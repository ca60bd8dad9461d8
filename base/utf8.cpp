#include "base/utf8.h"

namespace osteon::base {

std::size_t Utf8Length(std::string_view text) {
  const auto byte = [&text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto tail = [&byte](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  // The first byte determines the length. It also limits the values of the second byte (RFC 3629, section 4).
  const unsigned first = byte(0);
  if (first < 0x80u) return 1;
  if (first >= 0xC2u && first <= 0xDFu && tail(1)) return 2;
  if (first >= 0xE0u && first <= 0xEFu && tail(1) && tail(2)) {
    const bool overlong = first == 0xE0u && byte(1) < 0xA0u;
    const bool surrogate = first == 0xEDu && byte(1) >= 0xA0u;
    return overlong || surrogate ? 0 : 3;
  }
  if (first >= 0xF0u && first <= 0xF4u && tail(1) && tail(2) && tail(3)) {
    const bool overlong = first == 0xF0u && byte(1) < 0x90u;
    const bool beyond = first == 0xF4u && byte(1) >= 0x90u;
    return overlong || beyond ? 0 : 4;
  }
  return 0;
}

std::string Utf8(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = Utf8Length(text);
    if (length == 0)
      out += "\xEF\xBF\xBD";
    else
      out += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace osteon::base
