#pragma once

#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace osteon::simulation {

/// @throws std::invalid_argument unless min <= value <= max (NaN is outside); the message contains name,
///   value, minimum and maximum, in millimetres.
inline void CheckRangeMm(const std::string& name, double value_m, double min_m, double max_m) {
  if (value_m >= min_m && value_m <= max_m) return;
  throw std::invalid_argument(fmt::format("{}: found {:.6g} mm, accepted {:.6g} … {:.6g} mm", name,
                                          value_m * 1e3, min_m * 1e3, max_m * 1e3));
}

}  // namespace osteon::simulation
