#pragma once

#include "base/clock.h"

namespace osteon::surface {

/// Decides when a thread of SCHED_IDLE may work while it holds a lock that other threads want. If every CPU
/// is busy, the system suspends such a thread for a second or more in the middle of a step, and a thread that
/// wants the lock waits as long: between ordinary threads, a mutex's priority inheritance has no effect. So
/// after a suspension, the thread first rests. Then it tests, without the lock, whether a CPU is idle again.
/// The caller passes all times, so that tests need no clock.
class IdleShare {
 public:
  enum class Next {
    kWork,  ///< take the lock and work
    kRest,  ///< do nothing yet
    kTry,   ///< use kTryTime of CPU time without the lock, to see whether a CPU is idle
  };

  static constexpr rt::Nanoseconds kRestTime = rt::kSecond;
  /// CPU time that a try uses, without the lock: longer than the single time slice that a busy machine
  /// grants.
  static constexpr rt::Nanoseconds kTryTime = 15 * rt::kMillisecond;
  /// A stretch of work or a try with less wall time than this does not show whether the thread was suspended.
  static constexpr rt::Nanoseconds kMinTold = 20 * rt::kMillisecond;
  /// A thread that had a CPU for at least 1/5 of the wall time was not suspended
  static constexpr int kMinShare = 5;

  /// Returns what the thread is to do next, at the time `now`.
  [[nodiscard]] Next At(rt::Nanoseconds now) const {
    if (!put_off_) return Next::kWork;
    return now < rests_until_ ? Next::kRest : Next::kTry;
  }
  /// Call after a stretch of work, or a try, that ended at `now`.
  /// @param took  wall time of the stretch or try  @param on_cpu  its CPU time
  void Ended(rt::Nanoseconds now, rt::Nanoseconds took, rt::Nanoseconds on_cpu) {
    put_off_ = took >= kMinTold && on_cpu < took / kMinShare;
    if (put_off_) rests_until_ = now + kRestTime;
  }

 private:
  bool put_off_{false};  ///< the thread was suspended in its last stretch of work or try
  rt::Nanoseconds rests_until_{0};
};

}  // namespace osteon::surface
