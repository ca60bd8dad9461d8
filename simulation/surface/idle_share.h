#pragma once

#include "base/clock.h"

namespace osteon::surface {

/// Decides when a thread of SCHED_IDLE may work with a lock that other threads want. Where every CPU is busy,
/// the system puts such a thread off for a second or more in the middle of a step, and who wants the lock
/// waits as long: the priority that a mutex inherits counts for nothing between ordinary threads. So a thread
/// that was put off rests, and then tries without the lock whether a CPU is idle again. Times are given, so
/// that it can be tested without a clock.
class IdleShare {
 public:
  enum class Next { kWork, kRest, kTry };

  static constexpr rt::Nanoseconds kRestTime = rt::kSecond;
  /// CPU time of a try, without the lock: longer than the one turn that a busy machine grants.
  static constexpr rt::Nanoseconds kTryTime = 15 * rt::kMillisecond;
  static constexpr rt::Nanoseconds kMinTold = 20 * rt::kMillisecond;  ///< a shorter stretch tells nothing
  static constexpr int kMinShare = 5;  ///< a fifth of the time on a CPU: it was not put off

  /// The step to take at a time.
  [[nodiscard]] Next At(rt::Nanoseconds now) const {
    if (!put_off_) return Next::kWork;
    return now < rests_until_ ? Next::kRest : Next::kTry;
  }
  /// After a stretch of work, or a try, that ended at `now`. @param on_cpu  its CPU time
  void Ended(rt::Nanoseconds now, rt::Nanoseconds took, rt::Nanoseconds on_cpu) {
    put_off_ = took >= kMinTold && on_cpu < took / kMinShare;
    if (put_off_) rests_until_ = now + kRestTime;
  }

 private:
  bool put_off_{false};
  rt::Nanoseconds rests_until_{0};
};

}  // namespace osteon::surface
