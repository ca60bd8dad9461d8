#pragma once

#include <string>

#include <fmt/format.h>

namespace osteon::base {

/// Formats a number for a message to a person: at most ten digits, no trailing zeros ("0.1", "1e-05").
[[nodiscard]] inline std::string NumberText(double value) { return fmt::format("{:.10g}", value); }

}  // namespace osteon::base
