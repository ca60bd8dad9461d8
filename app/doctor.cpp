#include "app/doctor.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/utsname.h>

#include <algorithm>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/summary.h"
#include "control/rt/clock.h"
#include "control/rt/realtime_thread.h"
#include "gpu/devices.h"
#include "io/can/has_socket_can.h"
#include "io/fri/fri_link.h"

namespace osteon::app {
namespace {

constexpr const char* kGood = "good";
constexpr const char* kUsable = "usable";
constexpr const char* kMissing = "missing";

void ExamineVulkan(std::vector<Check>& checks) {
  const auto devices = gpu::ListDevices();
  if (!devices) {
    checks.push_back({"Vulkan", "no device", kMissing, devices.error()});
    return;
  }
  bool first = true;
  for (const gpu::DeviceInfo& device : *devices) {
    const bool runs = device.refusal.empty();
    const bool gpu = device.kind == "discrete" || device.kind == "integrated";
    checks.push_back(
        {"Vulkan device",
         fmt::format("{} ({}, Vulkan {}, {}, {:.1f} GiB)", device.name, device.kind, device.api_version,
                     device.driver, device.memory_bytes / (1024.0 * 1024.0 * 1024.0)),
         !runs ? kMissing
         : gpu ? kGood
               : kUsable,
         !runs   ? "refused: " + device.refusal
         : !gpu  ? "runs on the processor: fine for tests, not for a million spheres"
         : first ? "taken by default"
                 : "choose it with --device"});
    first = false;
  }
}

// How late a thread wakes that sleeps to absolute times, a millisecond apart.
void ExamineTimer(std::vector<Check>& checks) {
  std::vector<double> late;
  bool realtime = false;
  std::thread([&] {
    constexpr int kWakeups = 1000;
    realtime = rt::SetUpRealtimeThread({.priority = 80}).realtime;
    rt::Nanoseconds due = rt::MonotonicNow();
    for (int i = 0; i < kWakeups; ++i) {
      due += rt::kMillisecond;
      rt::SleepUntil(due);
      late.push_back(rt::ToSeconds(rt::MonotonicNow() - due));
    }
  }).join();
  const DurationFigures f = Quantiles(std::move(late));
  checks.push_back({"Real-time priority", realtime ? "SCHED_FIFO granted" : "SCHED_FIFO refused",
                    realtime ? kGood : kUsable,
                    realtime ? "" : "run as root, or give the user rtprio 80 in /etc/security/limits.conf"});
  const bool good = f.max_s < 200e-6, usable = f.p99_s < 500e-6;
  checks.push_back(
      {"Timer latency, 1000 wake-ups",
       fmt::format("p50 {:.0f}, p99 {:.0f}, max {:.0f} µs", f.p50_s * 1e6, f.p99_s * 1e6, f.max_s * 1e6),
       good     ? kGood
       : usable ? kUsable
                : kMissing,
       good ? "one second is a glance: measure for hours before an arm moves"
            : "simulation only; for an arm: PREEMPT_RT kernel, an isolated core, no virtual machine"});
}

void ExamineMemory(std::vector<Check>& checks) {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  static char page[4096];
  const bool locked = mlock(page, sizeof(page)) == 0;
  if (locked) munlock(page, sizeof(page));
  checks.push_back(
      {"Locked memory",
       limit.rlim_cur == RLIM_INFINITY ? "unlimited" : fmt::format("{} KiB", limit.rlim_cur / 1024),
       locked ? kGood : kUsable, locked ? "" : "memlock unlimited in /etc/security/limits.conf"});
}

void ExamineNetwork(std::vector<Check>& checks, std::uint16_t fri_port) {
  const auto link = io::FriLink::Open({.port = fri_port});
  checks.push_back(
      {"FRI port", fmt::format("127.0.0.1:{}", fri_port), link ? kGood : kMissing, link ? "" : link.error()});
  const bool can = io::HasSocketCan();
  checks.push_back({"SocketCAN", can ? "in this kernel" : "not in this kernel", can ? kGood : kUsable,
                    can ? "" : "needed for a real force sensor and spindle; the demo runs without"});
}

}  // namespace

std::vector<Check> Examine(std::uint16_t fri_port) {
  std::vector<Check> checks;
  utsname system{};
  uname(&system);
  checks.push_back(
      {"System",
       fmt::format("{} {}, {} processors", system.sysname, system.release,
                   std::thread::hardware_concurrency()),
       std::thread::hardware_concurrency() >= 2 ? kGood : kUsable,
       std::thread::hardware_concurrency() >= 2 ? "" : "servo loop and simulation share one processor"});
  ExamineVulkan(checks);
  ExamineTimer(checks);
  ExamineMemory(checks);
  ExamineNetwork(checks, fri_port);
  return checks;
}

int RunDoctor(std::uint16_t fri_port, const std::filesystem::path& json) {
  const std::vector<Check> checks = Examine(fri_port);
  nlohmann::json list = nlohmann::json::array();
  bool vulkan = false, port = false;
  for (const Check& check : checks) {
    fmt::print("{:<8} {:<30} {}\n", check.verdict, check.name, check.value);
    if (!check.advice.empty()) fmt::print("{:<8} {:<30} {}\n", "", "", check.advice);
    list.push_back(
        {{"name", check.name}, {"value", check.value}, {"verdict", check.verdict}, {"advice", check.advice}});
    vulkan = vulkan || (check.name == "Vulkan device" && check.verdict != kMissing);
    port = port || (check.name == "FRI port" && check.verdict == kGood);
  }
  if (!json.empty()) {
    const nlohmann::json out{{"schema", "osteon.doctor/1"}, {"checks", list}};
    if (const auto written = WriteText(json, out.dump(2) + "\n"); !written) {
      fmt::print(stderr, "osteon doctor: {}\n", written.error());
      return 2;
    }
  }
  return vulkan && port ? 0 : 1;
}

}  // namespace osteon::app
