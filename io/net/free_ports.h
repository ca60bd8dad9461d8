#pragma once

#include <cstdint>
#include <string>

#include <tl/expected.hpp>

namespace osteon::io {

/// The first of `count` ports of the loopback in a row that are free just now, UDP and TCP alike, below those
/// that systems hand out by themselves. Processes begin to look at different places, so that two that start
/// together seldom meet. The error says that there are none.
[[nodiscard]] tl::expected<std::uint16_t, std::string> FindFreePorts(int count);

}  // namespace osteon::io
