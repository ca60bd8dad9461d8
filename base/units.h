#pragma once

#include <numbers>

// Factors to SI from the units of files, manuals and protocols.

namespace osteon {

inline constexpr double kDegree = std::numbers::pi / 180.0;    ///< [rad]
inline constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;  ///< one turn per minute [rad/s]
inline constexpr double kMillimetre_m = 1e-3;

}  // namespace osteon
