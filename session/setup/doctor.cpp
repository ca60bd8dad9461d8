#include "session/setup/doctor.h"

#include <sys/utsname.h>

#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/run_progress.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "gpu/context/devices.h"
#include "io/can/has_socket_can.h"
#include "io/fri/fri_link.h"
#include "session/setup/cell_checks.h"
#include "session/setup/engine_choice.h"
#include "session/setup/realtime_checks.h"
#include "simulation/engine_cpu/cpu_engine.h"

namespace osteon::session {
namespace {

// Reports for each Vulkan device which requirements it does not meet, and which engine `auto` takes.
void ExamineVulkan(std::vector<Check>& checks) {
  const auto devices = gpu::ListDevices();
  if (!devices) checks.push_back({"Vulkan", "no device", kCheckUsable, devices.error()});
  bool is_first = true;
  for (const gpu::DeviceInfo& device : devices.value_or(std::vector<gpu::DeviceInfo>())) {
    const bool runs = device.refusal.empty();
    const bool gpu = IsGpu(device);
    checks.push_back(
        {"Vulkan device",
         fmt::format("{} ({}, Vulkan {}, {}, {:.1f} GiB)", device.name, device.kind, device.api_version,
                     device.driver, device.memory_bytes / (1024.0 * 1024.0 * 1024.0)),
         !runs ? kCheckMissing
         : gpu ? kCheckGood
               : kCheckUsable,
         !runs      ? "refused for what the next lines name; the CPU engine needs no device"
         : !gpu     ? "computes on the processor: for the shaders' tests; the CPU engine is faster"
         : is_first ? "taken by default"
                    : "choose it with --device"});
    if (runs)
      checks.push_back({"Vulkan arithmetic", gpu::ArithmeticText(device.arithmetic),
                        device.missing.empty() ? kCheckGood : kCheckUsable,
                        device.missing.empty() ? "" : "the device lacks " + gpu::NeedNames(device.missing)});
    for (const gpu::UnmetNeed& need : device.unmet)
      checks.push_back({"Vulkan need",
                        fmt::format("{}: found {}, accepted {}", need.name, need.found, need.accepted),
                        kCheckMissing, need.why});
    is_first = false;
  }
  const EngineChoice choice = ChooseEngine("auto", "", devices);
  checks.push_back({"Cutting engine",
                    choice.engine == "cpu"
                        ? "cpu: " + simulation::CpuDeviceText(simulation::CpuInstructionSets().front())
                        : choice.engine,
                    kCheckGood, "--engine auto takes it: " + choice.reason});
}

// Examines whether the FRI port is free on the loopback address, and whether the kernel has SocketCAN.
void ExamineNetwork(std::vector<Check>& checks, std::uint16_t fri_port) {
  const auto link = io::FriLink::Open({.port = fri_port});
  checks.push_back({"FRI port", fmt::format("127.0.0.1:{}", fri_port), link ? kCheckGood : kCheckMissing,
                    link ? "" : link.error(), true});
  const bool can = io::HasSocketCan();
  checks.push_back({"SocketCAN", can ? "in this kernel" : "not in this kernel",
                    can ? kCheckGood : kCheckUsable,
                    can ? "" : "needed for a real force sensor and spindle; the demo runs without"});
}

}  // namespace

std::vector<Check> Examine(const DoctorOptions& options, const std::function<void(double at_s)>& progress) {
  // load the cell first: if its file cannot be read, the command ends before the timer tests, which take
  // seconds
  const auto cell = options.cell.empty() ? std::nullopt : std::optional(config::LoadCell(options.cell));
  std::vector<Check> checks;
  utsname system{};
  uname(&system);
  checks.push_back(
      {"System",
       fmt::format("{} {}, {} processors", system.sysname, system.release,
                   std::thread::hardware_concurrency()),
       std::thread::hardware_concurrency() >= 2 ? kCheckGood : kCheckUsable,
       std::thread::hardware_concurrency() >= 2 ? "" : "servo loop and simulation share one processor"});
  ExamineVulkan(checks);
  ExamineRealtime(checks, options.seconds, progress);
  ExamineNetwork(checks, options.fri_port);
  if (cell) ExamineCell(checks, *cell);
  return checks;
}

int RunDoctor(const DoctorOptions& options) {
  base::RunProgress progress("osteon doctor", 2.0 * options.seconds);
  const std::vector<Check> checks = Examine(options, [&](double at_s) { progress.Show(at_s); });
  progress.Done();
  nlohmann::json list = nlohmann::json::array();
  bool can_run = true;
  for (const Check& check : checks) {
    fmt::print("{:<8} {:<30} {}\n", check.verdict, check.name, check.value);
    if (!check.advice.empty()) fmt::print("{:<8} {:<30} {}\n", "", "", check.advice);
    list.push_back(
        {{"name", check.name}, {"value", check.value}, {"verdict", check.verdict}, {"advice", check.advice}});
    if (check.is_required && check.verdict == kCheckMissing) can_run = false;
  }
  if (!options.json.empty()) {
    const nlohmann::json out{{"schema", "osteon.doctor/1"}, {"checks", list}};
    if (const auto written = base::WriteText(options.json, base::JsonText(out)); !written) {
      fmt::print(stderr, "osteon doctor: {}\n", written.error());
      return 2;
    }
  }
  return can_run ? 0 : 1;
}

}  // namespace osteon::session
