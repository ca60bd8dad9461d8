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

/// Counts `share` of work a millisecond for `ms` milliseconds of time that is made up.
void Work(PacedPriority& priority, Nanoseconds& now, double share, int ms) {
  for (int i = 0; i < ms; ++i, now += kMillisecond)
    priority.CountWork(now, now + static_cast<Nanoseconds>(share * static_cast<double>(kMillisecond)));
}

TEST(PacedPriority, GivesWayWhereItLeavesNoTimeAndComesBack) {
  const int at_first = Policy();
  const bool is_granted = IsGranted();
  std::thread([&] {
    PacedPriority priority;
    Nanoseconds now = 1;
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
