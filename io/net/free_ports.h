#pragma once

#include <cstdint>
#include <string>

#include <tl/expected.hpp>

namespace osteon::io {

/// Returns the first of `count` consecutive ports of the loopback interface that are now free for UDP and
/// TCP. They are below the range that operating systems assign automatically. Processes start the search at
/// different ports, so two processes that start together seldom find the same ports. The error says that
/// there are no such ports.
[[nodiscard]] tl::expected<std::uint16_t, std::string> FindFreePorts(int count);

}  // namespace osteon::io
