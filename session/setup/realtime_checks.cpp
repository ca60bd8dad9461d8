#include "session/setup/realtime_checks.h"

#include <grp.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "base/clock.h"
#include "base/realtime_thread.h"

namespace osteon::session {
namespace {

constexpr std::array<double, 3> kPeriods_s{1e-3, 2e-3, 5e-3};  // FRI periods that a cell may have
constexpr std::chrono::milliseconds kProgressInterval{50};     // time between two calls of `progress`

// First line of a file; empty if it cannot be read.
std::string FirstLine(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

// This process's soft limit of a resource (RLIMIT_…), in units of `unit`.
std::string LimitText(int resource, double unit) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limit);
  return limit.rlim_cur == RLIM_INFINITY ? "unlimited"
                                         : fmt::format("{:.0f}", static_cast<double>(limit.rlim_cur) / unit);
}

// Says how this user gets a right that the group "osteon" has.
std::string RightsAdvice(const std::string& right) {
  constexpr const char* kGroup = "osteon";
  const group* found = ::getgrnam(kGroup);
  if (found == nullptr)
    return fmt::format("{} for the group {}, which the Debian package makes (docs/set_up.md), or run as root",
                       right, kGroup);
  std::array<gid_t, 256> groups{};
  const int count = std::max(0, ::getgroups(static_cast<int>(groups.size()), groups.data()));
  const bool is_member = ::getegid() == found->gr_gid || std::find(groups.begin(), groups.begin() + count,
                                                                   found->gr_gid) != groups.begin() + count;
  return is_member ? fmt::format("{}: the group {} lacks it, see docs/set_up.md", right, kGroup)
                   : fmt::format("{}: sudo usermod -aG {} $USER, and log in anew", right, kGroup);
}

// Judges how late a thread woke. The verdict is good if this serves the shortest FRI period, usable if it
// serves the longest.
// @param counts  whether the servo loop would run in such a thread; if not, the verdict is never `missing`
Check TimerCheck(const char* name, const DurationFigures& late, bool counts) {
  const bool good = Serves(late, kPeriods_s.front()), usable = Serves(late, kPeriods_s.back());
  return {name,
          fmt::format("{} wake-ups, late by p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, max {:.0f} µs", late.count,
                      late.p50_s * 1e6, late.p99_s * 1e6, late.p999_s * 1e6, late.max_s * 1e6),
          good                ? kCheckGood
          : !counts || usable ? kCheckUsable
                              : kCheckMissing,
          !counts ? good ? "" : "what a thread without SCHED_FIFO would have: the loop is none"
          : good  ? "a glance: measure for hours before an arm moves (--seconds)"
                  : "simulation only; for an arm: PREEMPT_RT kernel, an isolated core, no virtual machine"};
}

// Says which FRI periods the machine can serve; none without SCHED_FIFO.
Check PeriodCheck(const DurationFigures& late, bool realtime) {
  std::string served;
  bool serves_any = false;
  for (const double period_s : kPeriods_s) {
    const bool serves = realtime && Serves(late, period_s);
    serves_any = serves_any || serves;
    served +=
        fmt::format("{}{:.0f} ms: {}", served.empty() ? "" : ", ", period_s * 1e3, serves ? "yes" : "no");
  }
  const bool serves_all = realtime && Serves(late, kPeriods_s.front());  // the shortest demands most
  return {"Servo periods", served,
          serves_all   ? kCheckGood
          : serves_any ? kCheckUsable
                       : kCheckMissing,
          serves_all  ? ""
          : !realtime ? "none is promised without SCHED_FIFO"
                      : "by p99.9 below a tenth of the period and max below half of it, with SCHED_FIFO"};
}

Check PriorityCheck(bool realtime) {
  return {"Real-time priority",
          fmt::format("SCHED_FIFO {}, rtprio limit {}", realtime ? "granted" : "refused",
                      LimitText(RLIMIT_RTPRIO, 1.0)),
          realtime ? kCheckGood : kCheckUsable, realtime ? "" : RightsAdvice("rtprio 95")};
}

// Tests whether memory can be locked as the servo thread locks it, and unlocks it again.
Check MemoryCheck() {
  bool locked = false;
  std::thread([&] {
    locked = rt::SetUpRealtimeThread({.priority = 0, .lock_memory = true}).memory_locked;
  }).join();
  munlockall();
  return {"Locked memory",
          fmt::format("{}, memlock limit {} KiB", locked ? "granted" : "refused",
                      LimitText(RLIMIT_MEMLOCK, 1024.0)),
          locked ? kCheckGood : kCheckUsable, locked ? "" : RightsAdvice("memlock unlimited")};
}

// Names CPU 0's deepest enabled idle state, and says whether a run may keep the CPUs out of idle states.
Check IdleCheck() {
  std::string deepest;
  const std::string device = "/dev/cpu_dma_latency";
  long max_us = -1;
  std::error_code error;
  for (const auto& state :
       std::filesystem::directory_iterator("/sys/devices/system/cpu/cpu0/cpuidle", error)) {
    const long latency_us = std::atol(FirstLine(state.path() / "latency").c_str());
    if (FirstLine(state.path() / "disable") == "1" || latency_us <= max_us) continue;
    max_us = latency_us;
    deepest = fmt::format("{}, {} µs to leave", FirstLine(state.path() / "name"), latency_us);
  }
  const bool awake = rt::KeepCpusAwake();
  const bool device_exists = std::filesystem::exists(device, error);
  return {"Idle states",
          fmt::format("{}; {}", deepest.empty() ? "none to be seen" : "deepest " + deepest,
                      awake ? "a run keeps out of them" : "a run sleeps into them"),
          awake ? kCheckGood : kCheckUsable,
          awake           ? ""
          : device_exists ? RightsAdvice("write access to " + device)
                          : "this kernel has no " + device + ": turn deep ones off in the firmware"};
}

Check KernelCheck() {
  utsname system{};
  uname(&system);
  const std::string version = system.version;
  const bool preempt_rt =
      FirstLine("/sys/kernel/realtime") == "1" || version.find("PREEMPT_RT") != std::string::npos;
  return {"Kernel",
          fmt::format("{} {}", system.release, preempt_rt ? "with PREEMPT_RT" : "without PREEMPT_RT"),
          preempt_rt ? kCheckGood : kCheckUsable,
          preempt_rt ? "" : "for an arm: apt install linux-image-rt-amd64"};
}

// Names the CPUs that the kernel keeps free of other threads (isolcpus).
Check IsolationCheck() {
  const std::string isolated = FirstLine("/sys/devices/system/cpu/isolated");
  return {"Isolated cores", isolated.empty() ? "none" : isolated,
          isolated.empty() ? kCheckUsable : kCheckGood,
          isolated.empty() ? "isolcpus=N nohz_full=N on the kernel's command line, then --cpu N"
                           : "name one of them: --cpu N"};
}

Check GovernorCheck() {
  std::set<std::string> governors;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/devices/system/cpu", error))
    if (const std::string name = FirstLine(entry.path() / "cpufreq/scaling_governor"); !name.empty())
      governors.insert(name);
  std::string text;
  for (const std::string& name : governors) text += (text.empty() ? "" : ", ") + name;
  const bool good = governors == std::set<std::string>{"performance"};
  return {"Frequency governor", text.empty() ? "not this system's to choose" : text,
          good ? kCheckGood : kCheckUsable,
          good           ? ""
          : text.empty() ? "a virtual machine, or the firmware chooses: turn its power saving off"
                         : "cpupower frequency-set -g performance"};
}

}  // namespace

bool Serves(const DurationFigures& late, double period_s) {
  return late.count > 0 && late.p999_s < period_s / 10.0 && late.max_s < period_s / 2.0;
}

DurationFigures TimerLatency(double seconds, bool& realtime,
                             const std::function<void(double at_s)>& progress) {
  const auto wakeups = static_cast<std::size_t>(std::max(1.0, std::round(seconds * 1e3)));
  std::vector<rt::Nanoseconds> late;
  late.reserve(wakeups);  // the thread fills this list; a DurationCounts would allocate memory in the thread
  std::atomic<bool> done{false};
  std::thread sleeper([&] {
    realtime = rt::SetUpRealtimeThread({.priority = realtime ? 80 : 0, .keep_cpus_awake = true}).realtime;
    rt::Nanoseconds due = rt::MonotonicNow();
    for (std::size_t i = 0; i < wakeups; ++i) {
      due += rt::kMillisecond;
      rt::SleepUntil(due);
      const rt::Nanoseconds woken = rt::MonotonicNow();
      late.push_back(woken - due);
      due = std::max(due, woken - rt::kMillisecond);  // a stall is one late wake-up, not many
    }
    done.store(true);
  });
  const rt::Nanoseconds begun = rt::MonotonicNow();
  while (!done.load()) {
    std::this_thread::sleep_for(kProgressInterval);
    if (progress) progress(std::min(seconds, rt::ToSeconds(rt::MonotonicNow() - begun)));
  }
  sleeper.join();
  report::DurationCounts counts;
  for (const rt::Nanoseconds each : late) counts.Add(each);
  return Quantiles(counts);
}

void ExamineRealtime(std::vector<Check>& checks, double seconds,
                     const std::function<void(double at_s)>& progress) {
  bool realtime = true, ordinary = false;
  const DurationFigures fifo = TimerLatency(seconds, realtime, progress);
  const DurationFigures plain = TimerLatency(seconds, ordinary, [&](double at_s) {
    if (progress) progress(seconds + at_s);
  });
  checks.push_back(PriorityCheck(realtime));
  if (realtime) checks.push_back(TimerCheck("Timer latency, SCHED_FIFO", fifo, true));
  checks.push_back(TimerCheck("Timer latency, ordinary thread", plain, !realtime));
  checks.push_back(PeriodCheck(fifo, realtime));
  checks.push_back(MemoryCheck());
  checks.push_back(IdleCheck());
  checks.push_back(KernelCheck());
  checks.push_back(IsolationCheck());
  checks.push_back(GovernorCheck());
}

}  // namespace osteon::session
