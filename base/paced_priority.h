#pragma once

#include "base/clock.h"

namespace osteon::rt {

/// Lifts the calling thread above every ordinary one (SCHED_FIFO 5, below servo and PLC) while it leaves time
/// to them: for the simulation, whose next frame must not wait for a third of a second behind a browser that
/// draws by the processor. A thread that has the CPU for more than 80 % of a tenth of a second runs as an
/// ordinary one until it has had it for less than half of one: it would keep the recorder and the views from
/// the CPU. Time in which the thread waits, for a lock, a disk or the CPU itself, is no work.
/// If the system does not grant real-time priorities, nothing changes. Used by one thread, which makes and
/// destroys it.
class PacedPriority {
 public:
  PacedPriority() noexcept;
  ~PacedPriority();
  PacedPriority(const PacedPriority&) = delete;
  PacedPriority& operator=(const PacedPriority&) = delete;

  /// Counts what the calling thread has worked since the last call. @param now  not decreasing
  void CountWork(Nanoseconds now) noexcept;
  /// The same with the thread's CPU time at `now`.
  void CountWork(Nanoseconds now, Nanoseconds cpu_time) noexcept;
  /// Whether the thread is lifted, as far as the system grants it.
  [[nodiscard]] bool is_lifted() const noexcept { return is_lifted_; }

 private:
  void Set(bool lifted) noexcept;

  bool is_lifted_{false};
  Nanoseconds window_start_{-1}, cpu_at_start_{0};
};

}  // namespace osteon::rt
