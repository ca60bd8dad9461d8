#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "control/tick_record.h"
#include "safety/acting_limits.h"
#include "simulation/engine/frame_record.h"

namespace osteon::console {

[[nodiscard]] inline double Length(const PlainVector3& v) { return std::hypot(v.x, v.y, v.z); }

/// Smallest and largest value of a window.
struct Extremes {
  double least{0.0}, most{0.0};

  void Begin(double value) { least = most = value; }
  void Add(double value) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
};

/// What a live view shows of some 30 ms: the last tick and the last frame, and the extremes of all ticks, so
/// that a peak between two pictures is never hidden. Plain data.
struct LiveWindow {
  std::uint64_t number{0};        ///< from 1, without gaps; 0: none yet
  control::TickRecord tick;       ///< the last one
  simulation::FrameRecord frame;  ///< the last one; model.frame is 0 before the first
  std::uint32_t ticks{0};         ///< in this window
  std::uint32_t limits{0};        ///< safety::LimitSet: every limit that acted in it
  /// Log time at which each of them began to act: without a whole window in which it did not.
  std::array<rt::Nanoseconds, safety::kLimitCount> limit_since{};
  Extremes force_N;                ///< of the coupling
  Extremes hand_N;                 ///< of the operator's hand
  Extremes speed_m_per_s;          ///< of the tool's apex, commanded
  Extremes compute_us, wakeup_us;  ///< of the tick; 0 in virtual time
  /// The value that 99 % of all ticks so far are below; 0 in virtual time.
  double compute_p99_us{0.0}, wakeup_p99_us{0.0};
  Extremes arm_age_s, interlock_age_s;  ///< of the arm's message, of the PLC's word; safety::kNoAge_s: none
  double rendered_s{0.0};               ///< so far, haptic and cutting
  double paused_s{0.0};                 ///< so far
};

}  // namespace osteon::console
