#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "control/tick_record.h"
#include "safety/acting_limits.h"
#include "simulation/engine/frame_record.h"

namespace osteon::console {

[[nodiscard]] inline double Length(const PlainVector3& v) { return std::hypot(v.x, v.y, v.z); }

/// The smallest and the largest value in a window.
struct Extremes {
  double least{0.0}, most{0.0};

  void Begin(double value) { least = most = value; }
  void Add(double value) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
};

/// The data of some 30 ms for a live view: the last tick, the last frame, and the extremes over all ticks.
/// The extremes show peaks between two pictures. Plain data.
struct LiveWindow {
  std::uint64_t number{0};        ///< from 1, without gaps; 0: none yet
  control::TickRecord tick;       ///< the last one
  simulation::FrameRecord frame;  ///< the last one; model.frame is 0 before the first
  std::uint32_t ticks{0};         ///< number of ticks in this window
  std::uint32_t limits{0};        ///< safety::LimitSet: every limit that acted in the window
  /// Log time at which each limit began to act. A limit that also acted in the previous window keeps its
  /// time.
  std::array<rt::Nanoseconds, safety::kLimitCount> limit_since{};
  Extremes force_N;                ///< force of the coupling
  Extremes hand_N;                 ///< force of the operator's hand
  Extremes speed_m_per_s;          ///< commanded speed of the tool's apex
  Extremes compute_us, wakeup_us;  ///< compute time and wake-up latency of a tick; 0 in virtual time
  /// 99th percentile of all ticks so far; 0 in virtual time.
  double compute_p99_us{0.0}, wakeup_p99_us{0.0};
  Extremes arm_age_s, interlock_age_s;  ///< ages of the newest message of the arm and of the PLC;
                                        ///< safety::kNoAge_s: no message
  double rendered_s{0.0};               ///< time spent rendering so far (states haptic and cutting)
  double paused_s{0.0};                 ///< so far
};

}  // namespace osteon::console
