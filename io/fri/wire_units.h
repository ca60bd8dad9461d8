#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "base/marker.h"

// Constants and helpers that the FRI encoder and decoder share. Private to the codec.

namespace osteon::io {

inline constexpr double kMmPerM = 1e3;                               ///< poses are in mm on the wire
inline constexpr std::size_t kMatrixSize = 12, kQuaternionSize = 7;  ///< numbers in a pose: FRI 1.x, 2.x

/// Whether all values are finite.
inline bool AllFinite(std::span<const double> values) OSTEON_RT {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace osteon::io
