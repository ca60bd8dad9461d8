#pragma once

#include <cstdint>

#include "base/marker.h"

namespace osteon::rt {

/// Nanoseconds on one monotonic scale: CLOCK_MONOTONIC in wall time, ticks since the start in virtual time.
using Nanoseconds = std::int64_t;

inline constexpr Nanoseconds kMillisecond = 1'000'000;
inline constexpr Nanoseconds kSecond = 1'000'000'000;

[[nodiscard]] constexpr double ToSeconds(Nanoseconds t) OSTEON_RT { return static_cast<double>(t) * 1e-9; }

/// Present time of CLOCK_MONOTONIC.
[[nodiscard]] Nanoseconds MonotonicNow() OSTEON_RT;

/// Sleeps until the given time of CLOCK_MONOTONIC; returns at once if that time has passed.
void SleepUntil(Nanoseconds time) OSTEON_RT;

}  // namespace osteon::rt
