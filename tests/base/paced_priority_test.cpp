#include "base/paced_priority.h"

#include <sched.h>

#include <thread>

#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

/// Scheduling policy of the calling thread, without its flags.
int Policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }

/// Whether this process may use real-time priorities.
bool IsGranted() {
  int policy = SCHED_OTHER;
  std::thread([&] {
    const PacedPriority priority;
    policy = Policy();
  }).join();
  return policy == SCHED_FIFO;
}

/// A simulated clock, and the simulated CPU time of the thread.
struct Times {
  Nanoseconds now{1}, cpu{0};
};

/// Advances the clock by `ms` milliseconds. The thread uses this share of a CPU meanwhile.
void Work(PacedPriority& priority, Times& times, double share, int ms) {
  for (int i = 0; i < ms; ++i) {
    times.now += kMillisecond;
    times.cpu += static_cast<Nanoseconds>(share * static_cast<double>(kMillisecond));
    priority.CountWork(times.now, times.cpu);
  }
}

// The thread loses its real-time priority if it uses more than 80 % of the CPU within 0.1 s. It gets the
// priority back below 50 %.
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
    times.now += 10 * kSecond;  // the thread waits for 10 s in one frame
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
