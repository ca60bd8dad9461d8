#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "base/clock.h"

namespace osteon::rt {

/// Measures how late each CPU of this machine wakes a thread: on each CPU a thread sleeps for a millisecond
/// at a time. If the watch has a priority above every other thread, a late wake-up shows that the CPU stood
/// still: a virtual machine's CPU stands still for tens of milliseconds while its host runs something else.
/// Without a priority, a late wake-up may also mean that the CPU was busy.
class CpuWatch {
 public:
  /// @param priority  SCHED_FIFO priority that the threads request; 0: ordinary threads
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
