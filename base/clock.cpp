#include "base/clock.h"

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

}  // namespace osteon::rt
