#include "control/rt/clock.h"

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <cerrno>

namespace osteon::rt {

Nanoseconds MonotonicNow() OSTEON_RT {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

void SleepUntil(Nanoseconds time) OSTEON_RT {
  const timespec t{.tv_sec = time / kSecond, .tv_nsec = time % kSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

bool RequestRealtimePriority(int priority) OSTEON_RT {
  const sched_param param{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &param) == 0;
}

}  // namespace osteon::rt
