#include "base/paced_priority.h"

#include <sched.h>
#include <ctime>

namespace osteon::rt {
namespace {

// shortest time over which the thread's work is compared with the limits
constexpr Nanoseconds kWindow = 100 * kMillisecond;
constexpr int kPriority = 5;  // SCHED_FIFO priority of a raised thread

}  // namespace

PacedPriority::PacedPriority() noexcept { Set(true); }

PacedPriority::~PacedPriority() {
  if (is_lifted_) Set(false);
}

void PacedPriority::CountWork(Nanoseconds now) noexcept {
  timespec cpu{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &cpu);
  CountWork(now, cpu.tv_sec * kSecond + cpu.tv_nsec);
}

void PacedPriority::CountWork(Nanoseconds now, Nanoseconds cpu_time) noexcept {
  if (window_start_ < 0) {
    window_start_ = now;
    cpu_at_start_ = cpu_time;
  }
  const Nanoseconds passed = now - window_start_, worked = cpu_time - cpu_at_start_;
  if (passed < kWindow) return;
  if (is_lifted_ && worked * 10 > passed * 8) Set(false);  // more than 80 % of the window
  if (!is_lifted_ && worked * 2 < passed) Set(true);       // less than half of it
  window_start_ = now;
  cpu_at_start_ = cpu_time;
}

void PacedPriority::Set(bool lifted) noexcept {
  is_lifted_ = lifted;
  const sched_param priority{.sched_priority = lifted ? kPriority : 0};
  // Threads that this thread starts (to pack coarser zones) must get an ordinary priority.
  (void)sched_setscheduler(0, lifted ? SCHED_FIFO | SCHED_RESET_ON_FORK : SCHED_OTHER, &priority);
}

}  // namespace osteon::rt
