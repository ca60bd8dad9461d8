#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "base/clock.h"

namespace osteon::studies {

/// Measures how long each CPU of this machine runs nothing that is due: a thread on each, above every other
/// one, sleeps for a millisecond at a time. A virtual machine's CPU may stand still for tens of milliseconds
/// while its host runs something else; whatever was to run on it is late then, however high its priority.
class CpuWatch {
 public:
  CpuWatch();
  ~CpuWatch();
  CpuWatch(const CpuWatch&) = delete;
  CpuWatch& operator=(const CpuWatch&) = delete;

  /// The latest that a thread was woken since the last call.
  [[nodiscard]] rt::Nanoseconds TakeLongest() { return longest_.exchange(0); }

 private:
  void Watch(int cpu);

  std::atomic<bool> ends_{false};
  std::atomic<rt::Nanoseconds> longest_{0};
  std::vector<std::thread> threads_;
};

}  // namespace osteon::studies
