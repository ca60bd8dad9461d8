#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace osteon::base {

/// Length of the UTF-8 sequence at the beginning of `text`, 0 if there is none (RFC 3629: no overlong form,
/// no surrogate, nothing beyond U+10FFFF).
[[nodiscard]] std::size_t Utf8Length(std::string_view text);

/// `text` with each byte that is not UTF-8 replaced by U+FFFD. Protobuf writes any bytes as a string but
/// refuses to read a string that is not UTF-8: a path or a comment in another encoding would make a recording
/// unreadable.
[[nodiscard]] std::string Utf8(std::string_view text);

}  // namespace osteon::base
