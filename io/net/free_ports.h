#pragma once

#include <cstdint>
#include <string>

#include <tl/expected.hpp>

namespace osteon::io {

/// The first of `count` consecutive ports of the loopback that are free now for UDP and TCP, below the range
/// that systems assign themselves. Processes start the search at different ports, so two that start together
/// seldom collide. The error says that there are none.
[[nodiscard]] tl::expected<std::uint16_t, std::string> FindFreePorts(int count);

}  // namespace osteon::io
