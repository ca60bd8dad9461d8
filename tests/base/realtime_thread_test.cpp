#include "base/realtime_thread.h"

#include <alloca.h>
#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace osteon::rt {
namespace {

// The CPUs on which the calling thread may run, in ascending order.
std::vector<int> AllowedCpus() {
  cpu_set_t mask;
  CPU_ZERO(&mask);
  pthread_getaffinity_np(pthread_self(), sizeof mask, &mask);
  std::vector<int> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &mask)) cpus.push_back(cpu);
  return cpus;
}

// The CPUs on which the calling thread is found, while it yields from time to time.
std::set<int> CpusRunOn() {
  std::set<int> seen;
  for (int i = 0; i < 50; ++i) {
    seen.insert(sched_getcpu());
    sched_yield();
  }
  return seen;
}

// Runs the body in a thread of its own, so that the settings do not stay in the test's process.
template <class Body>
void InThread(Body body) {
  std::thread(body).join();
}

TEST(RealtimeThread, RunsOnItsReservedCpuAndOtherThreadsDoNot) {
  InThread([] {
    const std::vector<int> cpus = AllowedCpus();
    const int cpu = cpus.back();
    ASSERT_EQ(ReserveCpu(cpu), "");
    RealtimeGrant grant;
    std::set<int> pinned_ran_on, other_ran_on;
    std::vector<int> pinned_allowed, other_allowed;
    {
      std::thread servo([&] {
        grant = SetUpRealtimeThread({.priority = 0, .cpu = cpu});
        pinned_ran_on = CpusRunOn();
        pinned_allowed = AllowedCpus();
      });
      std::thread worker([&] {
        other_ran_on = CpusRunOn();
        other_allowed = AllowedCpus();
      });
      servo.join();
      worker.join();
    }
    EXPECT_EQ(grant.cpu, cpu);
    EXPECT_EQ(pinned_ran_on, std::set<int>{cpu});
    EXPECT_EQ(pinned_allowed, std::vector<int>{cpu});
    if (cpus.size() == 1) GTEST_SKIP() << "one CPU: all share it";
    EXPECT_FALSE(other_ran_on.contains(cpu));
    EXPECT_EQ(other_allowed, std::vector<int>(cpus.begin(), cpus.end() - 1));
    EXPECT_FALSE(CpusRunOn().contains(cpu)) << "nor does the thread that reserved it run there";
    // a thread whose set of CPUs lacks this CPU still gets it on request, because child processes inherit
    // that set
    ASSERT_EQ(ReserveCpu(cpu), "");
    EXPECT_EQ(SetUpRealtimeThread({.priority = 0, .cpu = cpu}).cpu, cpu);
  });
}

TEST(RealtimeThread, SharesTheCpuIfThereIsOnlyOne) {
  InThread([] {
    const int cpu = AllowedCpus().front();
    ASSERT_EQ(SetUpRealtimeThread({.priority = 0, .cpu = cpu}).cpu, cpu);
    EXPECT_EQ(ReserveCpu(cpu), "");
    EXPECT_EQ(AllowedCpus(), std::vector<int>{cpu});
  });
}

TEST(RealtimeThread, NamesTheAvailableCpusIfTheGivenOneIsMissing) {
  InThread([] {
    const std::vector<int> before = AllowedCpus();
    const std::string wrong = ReserveCpu(kMaxCpu);
    EXPECT_NE(wrong.find("found 1023, accepted " + std::to_string(before.front())), std::string::npos)
        << wrong;
    EXPECT_NE(wrong.find(std::to_string(before.back())), std::string::npos) << wrong;
    EXPECT_EQ(AllowedCpus(), before) << "asking changes nothing";
    EXPECT_EQ(SetUpRealtimeThread({.priority = 0, .cpu = kMaxCpu}).cpu, -1);
    EXPECT_EQ(ReserveCpu(-1), "");
    EXPECT_EQ(AllowedCpus(), before);
  });
}

TEST(RealtimeThread, HasExactlyThePriorityThatItWasGranted) {
  InThread([] {
    EXPECT_FALSE(SetUpRealtimeThread({.priority = 0}).realtime);
    EXPECT_EQ(sched_getscheduler(0), SCHED_OTHER);
    const RealtimeGrant grant = SetUpRealtimeThread({.priority = 7});
    int policy = -1;
    sched_param param{};
    ASSERT_EQ(pthread_getschedparam(pthread_self(), &policy, &param), 0);
    EXPECT_EQ(policy, grant.realtime ? SCHED_FIFO : SCHED_OTHER);
    EXPECT_EQ(param.sched_priority, grant.realtime ? 7 : 0);
  });
}

// Number of page faults of this thread so far that needed no disk access.
long PageFaults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

// Writes to `bytes` of the stack below the present frame.
[[gnu::noinline]] void UseStack(std::size_t bytes) {
  auto* const room = static_cast<volatile char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += 1024) room[i] = 1;
}

// A thread's stack is touched in advance. Then its first deep call must cause no page fault.
TEST(RealtimeThread, ATouchedStackHasNoPageFaultsLeft) {
#if defined(OSTEON_SANITIZED)
  GTEST_SKIP() << "under a sanitizer: its shadow memory has faults of its own";
#endif
  constexpr std::size_t kStack = 512 * 1024;
  // page faults of the deep call, if `prefault` bytes of the stack were touched before
  const auto faults_of = [](std::size_t prefault) {
    long faults = 0;
    InThread([&] {
      SetUpRealtimeThread({.priority = 0, .prefault_stack_bytes = prefault});
      const long before = PageFaults();
      UseStack(kStack - 16 * 1024);
      faults = PageFaults() - before;
    });
    return faults;
  };
  EXPECT_EQ(faults_of(kStack), 0);
}

TEST(RealtimeThread, LocksMemoryOnlyOnRequest) {
#if defined(OSTEON_SANITIZED)
  GTEST_SKIP() << "under a sanitizer: it takes mlockall and locks nothing";
#endif
  // size of this process's locked memory [KiB]; -1 if the system does not report it
  const auto locked_kib = [] {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
      if (word == "VmLck:") {
        long kib = -1;
        status >> kib;
        return kib;
      }
    return -1L;
  };
  ASSERT_EQ(locked_kib(), 0);
  EXPECT_FALSE(SetUpRealtimeThread({.priority = 0}).memory_locked);
  EXPECT_EQ(locked_kib(), 0);
  const RealtimeGrant grant = SetUpRealtimeThread({.priority = 0, .lock_memory = true});
  EXPECT_EQ(locked_kib() > 0, grant.memory_locked);
  munlockall();
}

// If the request is granted, /dev/cpu_dma_latency stays open. A second request must not open it again.
TEST(RealtimeThread, KeepsTheCpusAwakeIfItReportsSo) {
  // number of this process's descriptors that are open on /dev/cpu_dma_latency
  const auto held = [] {
    int count = 0;
    for (const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) {
      std::error_code gone;
      count += std::filesystem::read_symlink(file.path(), gone) == "/dev/cpu_dma_latency";
    }
    return count;
  };
  EXPECT_FALSE(SetUpRealtimeThread({.priority = 0}).cpus_awake);
  EXPECT_EQ(held(), 0);
  const RealtimeGrant grant = SetUpRealtimeThread({.priority = 0, .keep_cpus_awake = true});
  EXPECT_EQ(held(), grant.cpus_awake ? 1 : 0);
  const int file = open("/dev/cpu_dma_latency", O_WRONLY);
  EXPECT_EQ(grant.cpus_awake, file >= 0);
  if (file >= 0) close(file);
  EXPECT_EQ(KeepCpusAwake(), grant.cpus_awake);
  EXPECT_EQ(held(), grant.cpus_awake ? 1 : 0);
}

TEST(RealtimeThread, RefusesParametersOutsideTheirRange) {
  const auto says = [](const RealtimeThreadParams& params, const std::string& text) {
    try {
      Validate(params);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  says({.priority = 100}, "priority: found 100, accepted 0 … 99");
  says({.cpu = -2}, "cpu: found -2, accepted -1 … 1023");
  says({.prefault_stack_bytes = (1 << 20) + 1}, "prefault_stack_bytes: found 1048577, accepted 0 … 1048576");
}

}  // namespace
}  // namespace osteon::rt
