#pragma once

#include "base/clock.h"

namespace osteon::rt {

/// Raises the calling thread above every ordinary thread (SCHED_FIFO 5, below the threads of servo loop and
/// PLC), as long as it leaves CPU time to the ordinary threads. Used for the simulation: without it, a frame
/// may wait a third of a second while a browser draws on the same processor.
///
/// A raised thread that works for more than 80 % of a window of 0.1 s becomes an ordinary thread, because it
/// would keep the recorder and the views from the CPU. It is raised again after a window in which it worked
/// for less than half of the time. Time in which the thread waits for a lock, a disk or a CPU is not counted
/// as work.
///
/// If the system does not grant real-time priorities, nothing changes. One thread creates, uses and destroys
/// this object.
class PacedPriority {
 public:
  PacedPriority() noexcept;
  ~PacedPriority();
  PacedPriority(const PacedPriority&) = delete;
  PacedPriority& operator=(const PacedPriority&) = delete;

  /// Adds the CPU time that the calling thread has used since the last call. @param now  not decreasing
  void CountWork(Nanoseconds now) noexcept;
  /// As above, with the thread's CPU time at `now` given by the caller.
  void CountWork(Nanoseconds now, Nanoseconds cpu_time) noexcept;
  /// Whether raising the thread was requested last. The system may have refused it.
  [[nodiscard]] bool is_lifted() const noexcept { return is_lifted_; }

 private:
  /// Raises the calling thread, or makes it an ordinary one.
  void Set(bool lifted) noexcept;

  bool is_lifted_{false};
  Nanoseconds window_start_{-1}, cpu_at_start_{0};
};

}  // namespace osteon::rt
