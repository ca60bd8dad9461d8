#include "base/cpu_watch.h"

#include <sched.h>

#include "base/realtime_thread.h"

namespace osteon::rt {

CpuWatch::CpuWatch(int priority) {
  cpu_set_t cpus;
  if (sched_getaffinity(0, sizeof cpus, &cpus) != 0) return;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &cpus))
      threads_.emplace_back([this, cpu, priority] { Watch(cpu, priority); });
}

CpuWatch::~CpuWatch() {
  ends_.store(true);
  for (std::thread& thread : threads_) thread.join();
}

void CpuWatch::Watch(int cpu, int priority) {
  NameThread("cpu watch");
  SetUpRealtimeThread({.priority = priority, .cpu = cpu});
  while (!ends_.load()) {
    const Nanoseconds due = MonotonicNow() + kMillisecond;
    SleepUntil(due);
    const Nanoseconds late = MonotonicNow() - due;
    // the loop below raises longest_ to `late`, unless another thread has stored more
    Nanoseconds longest = longest_.load();
    while (late > longest && !longest_.compare_exchange_weak(longest, late)) {
    }
  }
}

}  // namespace osteon::rt
