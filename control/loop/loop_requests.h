#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "base/marker.h"
#include "control/tick_record.h"

namespace osteon::control {

/// Requests to the loop. Any thread may make them, and a signal handler may.
class LoopRequests {
 public:
  void AllowStart(bool allowed) OSTEON_RT { may_start_.store(allowed, std::memory_order_relaxed); }
  void RequestStop() OSTEON_RT { stop_.store(true, std::memory_order_relaxed); }
  void RequestRecovery() OSTEON_RT { recovery_.store(true, std::memory_order_relaxed); }
  void RequestPause() OSTEON_RT { pause_.store(true, std::memory_order_relaxed); }
  /// @param index  index in the loop's table of tools
  void RequestTool(int index) OSTEON_RT { tool_.store(index, std::memory_order_relaxed); }
  void RequestResume() OSTEON_RT { resume_.store(true, std::memory_order_relaxed); }

  /// Stores a gain of the guidance, clamped to 0 … 1; ignores one that is not a number.
  void RequestGuidanceGain(double gain) OSTEON_RT {
    if (!std::isnan(gain)) guidance_gain_.store(std::clamp(gain, 0.0, 1.0), std::memory_order_relaxed);
  }

  /// See ServoLoop's functions of the same names. Call from the tick's thread.
  void ReportDifference() OSTEON_RT { differed_ = true; }
  void ReportRecorder() OSTEON_RT { recorder_stalled_ = true; }

  // For the tick. A stop request stays set; any other request is returned only once.
  [[nodiscard]] bool may_start() const OSTEON_RT { return may_start_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool stop() const OSTEON_RT { return stop_.load(std::memory_order_relaxed); }
  /// Returns the index of the tool that was requested since the last call, and clears the request; -1: none.
  [[nodiscard]] int TakeTool() OSTEON_RT { return tool_.exchange(-1, std::memory_order_relaxed); }
  /// Moves all other requests made since the last call into the tick's input.
  void TakeInto(TickInput& input) OSTEON_RT {
    input.recover = recovery_.exchange(false, std::memory_order_relaxed);
    input.pause = pause_.exchange(false, std::memory_order_relaxed);
    input.resume = resume_.exchange(false, std::memory_order_relaxed);
    const double guidance_gain = guidance_gain_.exchange(kNone, std::memory_order_relaxed);
    input.has_guidance_gain = !std::isnan(guidance_gain);
    if (input.has_guidance_gain) input.guidance_gain = guidance_gain;
    input.repeat_differed = std::exchange(differed_, false);
    input.recorder_stalled = std::exchange(recorder_stalled_, false);
  }

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::atomic<bool> may_start_{true}, stop_{false}, recovery_{false}, pause_{false}, resume_{false};
  std::atomic<int> tool_{-1};
  std::atomic<double> guidance_gain_{kNone};
  bool differed_{false}, recorder_stalled_{false};
  static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                std::atomic<double>::is_always_lock_free);
};

}  // namespace osteon::control
