#include "base/inheriting_mutex.h"

#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

constexpr int kPriority = 5;  // SCHED_FIFO priority of the waiting thread

/// The priority at which the system runs the calling thread; below 0 if it is a real-time priority.
/// @see proc(5), field 18 of stat
int CurrentPriority() {
  std::ifstream file("/proc/thread-self/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream fields(text.substr(text.rfind(')') + 2));
  int value = 0;
  std::string skipped;
  for (int field = 3; field < 18; ++field) fields >> skipped;
  fields >> value;
  return value;
}

TEST(InheritingMutex, OnlyOneThreadHoldsIt) {
  InheritingMutex mutex;
  long sum = 0;
  const auto add = [&] {
    for (int i = 0; i < 20000; ++i) {
      const std::lock_guard lock(mutex);
      ++sum;
    }
  };
  std::thread other(add);
  add();
  other.join();
  EXPECT_EQ(sum, 40000);
  const std::lock_guard lock(mutex);
  bool taken = true;
  std::thread([&] { taken = mutex.try_lock(); }).join();
  EXPECT_FALSE(taken);
}

// While a real-time thread waits for the mutex, the ordinary thread that holds the mutex must run with the
// waiter's priority.
TEST(InheritingMutex, TheHolderInheritsThePriorityOfTheWaiter) {
  InheritingMutex mutex;
  std::unique_lock lock(mutex);
  if (CurrentPriority() < 0) GTEST_SKIP() << "the tests themselves are real-time";
  std::atomic<bool> granted{false}, ended{false};
  std::thread waiter([&] {
    const sched_param priority{.sched_priority = kPriority};
    granted = sched_setscheduler(0, SCHED_FIFO, &priority) == 0;
    ended = !granted;
    const std::lock_guard waits(mutex);
  });
  // wait up to 60 s, because the machine may be busy; if a CPU is idle, the priority changes at once
  for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
       CurrentPriority() >= 0 && !ended && std::chrono::steady_clock::now() < end;)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const int boosted = CurrentPriority();
  lock.unlock();
  waiter.join();
  if (!granted) GTEST_SKIP() << "no real-time priorities for this process";
  EXPECT_EQ(boosted, -1 - kPriority);
  EXPECT_GE(CurrentPriority(), 0) << "afterwards it is an ordinary thread again";
}

}  // namespace
}  // namespace osteon::rt
