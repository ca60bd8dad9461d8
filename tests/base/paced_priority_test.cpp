#include "base/paced_priority.h"

#include <sched.h>

#include <thread>

#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

/// Policy of the calling thread, without its flags.
int Policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }

/// Whether this process may have real-time priorities.
bool IsGranted() {
  int policy = SCHED_OTHER;
  std::thread([&] {
    const PacedPriority priority;
    policy = Policy();
  }).join();
  return policy == SCHED_FIFO;
}

/// Made-up clock and CPU time of the thread.
struct Times {
  Nanoseconds now{1}, cpu{0};
};

/// Advances the clock by `ms` milliseconds, in which the thread uses this share of a CPU.
void Work(PacedPriority& priority, Times& times, double share, int ms) {
  for (int i = 0; i < ms; ++i) {
    times.now += kMillisecond;
    times.cpu += static_cast<Nanoseconds>(share * static_cast<double>(kMillisecond));
    priority.CountWork(times.now, times.cpu);
  }
}

// The thread loses its priority if it works for more than 80 % of 0.1 s, and regains it below 50 %.
TEST(PacedPriority, DropsIfTheThreadUsesTheWholeCpuAndReturnsLater) {
  const int at_first = Policy();
  const bool is_granted = IsGranted();
  std::thread([&] {
    PacedPriority priority;
    Times now;
    Work(priority, now, 0.4, 1000);
    EXPECT_TRUE(priority.is_lifted());
    Work(priority, now, 0.95, 250);
    EXPECT_FALSE(priority.is_lifted());
    EXPECT_EQ(Policy(), SCHED_OTHER);
    Work(priority, now, 0.7, 1000);
    EXPECT_FALSE(priority.is_lifted()) << "between the two shares nothing changes";
    Work(priority, now, 0.3, 250);
    EXPECT_TRUE(priority.is_lifted());
    EXPECT_EQ(Policy(), is_granted ? SCHED_FIFO : SCHED_OTHER);
  }).join();
  EXPECT_EQ(Policy(), at_first) << "of other threads";
}

TEST(PacedPriority, TimeSpentWaitingDoesNotCountAsWork) {
  std::thread([] {
    PacedPriority priority;
    Times times;
    Work(priority, times, 0.2, 150);
    times.now += 10 * kSecond;  // held up in one frame
    Work(priority, times, 0.2, 150);
    EXPECT_TRUE(priority.is_lifted());
  }).join();
}

TEST(PacedPriority, EndsWithItsObjectAndIsNotInherited) {
  std::thread([] {
    {
      const PacedPriority priority;
      int child = -1;
      std::thread([&] { child = Policy(); }).join();
      EXPECT_EQ(child, SCHED_OTHER);
    }
    EXPECT_EQ(Policy(), SCHED_OTHER);
  }).join();
}

}  // namespace
}  // namespace osteon::rt
