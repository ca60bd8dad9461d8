#include "studies/soak/cpu_watch.h"

#include <sched.h>

#include "base/realtime_thread.h"

namespace osteon::studies {
namespace {

constexpr int kPriority = 90;  // above the servo loop's and the simulated arm's

}  // namespace

CpuWatch::CpuWatch() {
  cpu_set_t cpus;
  if (sched_getaffinity(0, sizeof cpus, &cpus) != 0) return;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &cpus)) threads_.emplace_back([this, cpu] { Watch(cpu); });
}

CpuWatch::~CpuWatch() {
  ends_.store(true);
  for (std::thread& thread : threads_) thread.join();
}

void CpuWatch::Watch(int cpu) {
  rt::NameThread("cpu watch");
  rt::SetUpRealtimeThread({.priority = kPriority, .cpu = cpu});
  rt::Nanoseconds due = rt::MonotonicNow();
  while (!ends_.load()) {
    due += rt::kMillisecond;
    rt::SleepUntil(due);
    const rt::Nanoseconds now = rt::MonotonicNow(), late = now - due;
    rt::Nanoseconds longest = longest_.load();
    while (late > longest && !longest_.compare_exchange_weak(longest, late)) {
    }
    if (late > rt::kMillisecond) due = now;
  }
}

}  // namespace osteon::studies
