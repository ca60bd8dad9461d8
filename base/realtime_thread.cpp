#include "base/realtime_thread.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#include <cstdlib>  // alloca

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace osteon::rt {
namespace {

constexpr std::size_t kMaxPrefault = 1 << 20;  // bytes; a thread's stack has 8 MiB by default
constexpr std::size_t kPage = 4096;            // bytes of the smallest page
constexpr unsigned kCapIpcLock = 14;           // the capability to lock memory, linux/capability.h

static_assert(kMaxCpu == CPU_SETSIZE - 1);

// Refuses a parameter outside of low … high.
void Require(const char* name, long value, long low, long high) {
  if (value < low || value > high)
    throw std::invalid_argument(std::string(name) + ": found " + std::to_string(value) + ", accepted " +
                                std::to_string(low) + " … " + std::to_string(high));
}

// Mask that contains one CPU.
cpu_set_t MaskOfCpu(int cpu) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  return set;
}

// Lets the calling thread run on this CPU only. False if the system refuses it, or if `cpu` is no CPU's
// number.
bool Pin(int cpu) noexcept {
  if (cpu < 0 || cpu > kMaxCpu) return false;
  const cpu_set_t set = MaskOfCpu(cpu);
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0;
}

// Whether this process may lock memory without limit. With a limit, locked memory could make a later
// allocation fail.
bool LocksWithoutLimit() noexcept {
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY) return true;
  std::FILE* file = std::fopen("/proc/self/status", "r");
  if (!file) return false;
  unsigned long long capabilities = 0;
  for (char line[256]; std::fgets(line, sizeof line, file);)
    if (std::sscanf(line, "CapEff: %llx", &capabilities) == 1) break;
  std::fclose(file);
  return (capabilities >> kCapIpcLock & 1) != 0;
}

// Locks each page only when it is first used (MCL_ONFAULT). Otherwise the whole stacks of all threads and the
// address space that a graphics driver reserves would occupy memory.
bool LockMemory() noexcept {
  return LocksWithoutLimit() && mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0;
}

// Writes to each page of the stack below the caller, so that no later call waits for a page.
[[gnu::noinline]] void TouchStack(std::size_t bytes) noexcept {
  auto* const room = static_cast<volatile char*>(alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += kPage) room[i] = 0;
}

// The CPUs that the system lets this process use. The present mask does not list all of them: a core that is
// isolated from the scheduler (isolcpus) is missing. There is no query for them, so each CPU is tried.
std::vector<int> CpusOfThisProcess(const cpu_set_t& present) {
  std::vector<int> cpus;
  const long count = sysconf(_SC_NPROCESSORS_CONF);
  for (int cpu = 0; cpu < count && cpu <= kMaxCpu; ++cpu)
    if (Pin(cpu)) cpus.push_back(cpu);
  pthread_setaffinity_np(pthread_self(), sizeof present, &present);
  return cpus;
}

// Formats numbers in rising order as "0 … 3, 8".
std::string Ranges(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(numbers[i]);
    if (last > i) text += " … " + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace

void Validate(const RealtimeThreadParams& params) {
  Require("priority", params.priority, 0, 99);
  Require("cpu", params.cpu, -1, kMaxCpu);
  Require("prefault_stack_bytes", static_cast<long>(params.prefault_stack_bytes), 0, kMaxPrefault);
}

void NameThread(const char* name) noexcept { pthread_setname_np(pthread_self(), name); }

void RaisePriority() noexcept {
  const sched_param priority{.sched_priority = 10};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
}

void LowerPriority() noexcept {
  constexpr int kNice = 10;
  (void)setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNice);
}

bool KeepCpusAwake() noexcept {
  static const bool awake = [] {
    const int file = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
    if (file < 0) return false;
    const std::int32_t max_latency_us = 0;
    if (write(file, &max_latency_us, sizeof max_latency_us) == sizeof max_latency_us)
      return true;  // the kernel honours the request as long as the file is open
    close(file);
    return false;
  }();
  return awake;
}

RealtimeGrant SetUpRealtimeThread(const RealtimeThreadParams& params) noexcept {
  RealtimeGrant grant;
  if (Pin(params.cpu)) grant.cpu = params.cpu;
  grant.memory_locked = params.lock_memory && LockMemory();
  grant.cpus_awake = params.keep_cpus_awake && KeepCpusAwake();
  if (params.prefault_stack_bytes > 0)
    TouchStack(params.prefault_stack_bytes < kMaxPrefault ? params.prefault_stack_bytes : kMaxPrefault);
  // The priority is raised last, because the calls above may take long.
  const sched_param priority{.sched_priority = params.priority};
  grant.realtime = params.priority > 0 && pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority) == 0;
  return grant;
}

std::string ReserveCpu(int cpu) {
  if (cpu < 0) return {};
  cpu_set_t mask;
  CPU_ZERO(&mask);
  pthread_getaffinity_np(pthread_self(), sizeof mask, &mask);
  if (!Pin(cpu)) return "found " + std::to_string(cpu) + ", accepted " + Ranges(CpusOfThisProcess(mask));
  CPU_CLR(static_cast<std::size_t>(cpu), &mask);
  if (CPU_COUNT(&mask) == 0) mask = MaskOfCpu(cpu);  // the machine has only this CPU: all threads share it
  pthread_setaffinity_np(pthread_self(), sizeof mask, &mask);
  return {};
}

}  // namespace osteon::rt
