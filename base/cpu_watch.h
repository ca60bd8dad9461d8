#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "base/clock.h"

namespace osteon::rt {

/// Measures how late each CPU of this machine wakes a thread: on each CPU a thread sleeps for a millisecond
/// at a time. With a priority above every other thread, the watch finds a CPU that stands still, as a virtual
/// machine's CPU does for tens of milliseconds while its host runs something else. Without a priority it also
/// finds a CPU that is busy.
class CpuWatch {
 public:
  /// @param priority  of the threads, SCHED_FIFO, if it is granted; 0: ordinary threads
  explicit CpuWatch(int priority);
  ~CpuWatch();
  CpuWatch(const CpuWatch&) = delete;
  CpuWatch& operator=(const CpuWatch&) = delete;

  /// Longest delay of a wake-up so far.
  [[nodiscard]] Nanoseconds longest() const { return longest_.load(); }
  /// Returns the longest delay since the last call.
  [[nodiscard]] Nanoseconds TakeLongest() { return longest_.exchange(0); }

 private:
  /// The loop of one thread, pinned to `cpu`.
  void Watch(int cpu, int priority);

  std::atomic<bool> ends_{false};
  std::atomic<Nanoseconds> longest_{0};
  std::vector<std::thread> threads_;
};

}  // namespace osteon::rt
