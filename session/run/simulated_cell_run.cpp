#include "session/run/simulated_cell_run.h"

#include <chrono>
#include <cstdio>
#include <exception>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/write_text.h"
#include "config/reading/check_plan_in_cell.h"
#include "io/fri/session_name.h"
#include "session/procedure/prepare_session.h"
#include "session/process/output.h"
#include "session/run/arm_connection.h"
#include "session/run/cell_console.h"
#include "session/run/cell_ports.h"
#include "session/run/cell_screen.h"
#include "session/run/cell_trace.h"
#include "session/run/simulated_setup.h"
#include "session/setup/identified_notice.h"

namespace osteon::session {
namespace {

// Time between two reads of the cell's state. It is short, so that the arm's state is read soon after its
// client has gone: see "stop" in ToJson.
constexpr std::chrono::milliseconds kStateInterval{2};

nlohmann::ordered_json WireJson(const hil::WireCounters& n) {
  return {{"pushed", n.pushed},         {"passed", n.passed},       {"lost", n.lost},
          {"duplicated", n.duplicated}, {"reordered", n.reordered}, {"corrupted", n.corrupted},
          {"delayed", n.delayed},       {"silenced", n.silenced},   {"overflow", n.overflow}};
}

// Prints the addresses at which a controller reaches the simulated arm, drives and PLC.
void PrintSimulatedSide(const config::CellConfig& cell) {
  fmt::print("osteon cell: the arm sends {} to {}:{}{}\n", Describe(cell.link),
             cell.guard ? cell.guard->host : cell.link.host, cell.guard ? cell.guard->port : cell.link.port,
             cell.guard ? ", the guard's" : "");
  for (const io::CanBusParams& bus : cell.devices.buses)
    fmt::print("osteon cell: CAN bus {} is a tunnel between 127.0.0.1:{} and the devices' {}\n", bus.name,
               bus.port, bus.device_port);
  if (cell.devices.plc)
    fmt::print("osteon cell: the PLC listens on {}:{}\n", cell.devices.plc->address, cell.devices.plc->port);
  fmt::print("osteon cell: Ctrl-C ends it\n");
  std::fflush(stdout);
}

// Opens the page that shows the cell; null if the page is off or cannot be opened: the cell then runs without
// a page.
std::unique_ptr<CellConsole> OpenPage(const SimulatedCellOptions& options, const config::CellConfig& cell) {
  if (!options.console.on) return nullptr;
  auto page = CellConsole::Open(options.console, cell, options.cell.stem().string(), options.seconds);
  if (page) {
    fmt::print("osteon cell: console: {}\n", (*page)->url());
    return std::move(*page);
  }
  fmt::print(stderr, "osteon cell: warning: {}\n", page.error());
  return nullptr;
}

// Passes each cycle of the arm from its thread's ring to the trace file and to the page, if these exist.
struct CycleReaders {
  rt::SpscRing<hil::CellState> cycles{2048};  // space for two seconds at 1 kHz
  std::unique_ptr<CellTraceWriter> trace;
  std::unique_ptr<CellConsole> page;

  [[nodiscard]] bool any() const { return trace || page; }
  void Pass() {
    hil::CellState cycle;
    while (cycles.Pop(cycle)) {
      if (trace) trace->Write(cycle);
      if (page) page->TakeCycle(cycle);
    }
    if (trace) trace->Flush();
  }
};

}  // namespace

std::string ToJson(const hil::CellHostState& state, const config::ArmLinkConfig& link) {
  const hil::CellState& arm = state.arm.cell;
  const hil::FriCounters& counters = arm.counters;
  const nlohmann::ordered_json json{
      {"schema", "osteon.cell/1"},
      {"arm",
       {{"session", io::SessionName(arm.session)},
        {"rsi",
         link.rsi() ? nlohmann::ordered_json(RsiStateText(arm.session)) : nlohmann::ordered_json(nullptr)},
        {"realtime_priority", state.arm.thread.realtime},
        {"memory_locked", state.arm.thread.memory_locked},
        {"cpu", state.arm.thread.cpu >= 0 ? nlohmann::ordered_json(state.arm.thread.cpu)
                                          : nlohmann::ordered_json(nullptr)},
        {"stop", hil::DescribeStop(arm)},
        {"commanding_s", arm.cell_time_s},
        {"script_done", arm.script_done},
        {"overruns", state.arm.overruns},
        {"undelivered", state.arm.undelivered},
        {"sent", counters.sent},
        {"answered", counters.answered},
        {"lost", counters.lost},
        {"excused", counters.excused},
        {"stale", counters.stale},
        {"duplicate", counters.duplicate},
        {"malformed", counters.malformed},
        {"client_gap", counters.client_gap},
        {"client_back", counters.client_back},
        {"delay", arm.delay}}},
      {"plc",
       {{"run_permitted", state.plc.run_permitted},
        {"power_on", state.plc.power_on},
        {"blocks", hil::DescribeBlocks(state.plc.blocks)},
        {"requests", state.plc_counters.requests},
        {"connections", state.plc_counters.connections}}},
      {"wires",
       {{"arm_to_controller", WireJson(state.arm.wires.arm_to_controller)},
        {"arm_from_controller", WireJson(state.arm.wires.arm_from_controller)},
        {"sensor_to_controller", WireJson(state.devices.sensor_to_controller)},
        {"sensor_from_controller", WireJson(state.devices.sensor_from_controller)},
        {"drive_to_controller", WireJson(state.devices.drive_to_controller)},
        {"drive_from_controller", WireJson(state.devices.drive_from_controller)}}},
      {"spindle", {{"speed_rad_per_s", state.tool_speed_rad_per_s}}}};
  return base::JsonText(json);
}

int RunSimulatedCell(const SimulatedCellOptions& options) {
  if (const std::string wrong = rt::ReserveCpu(options.cpu); !wrong.empty()) {
    fmt::print(stderr, "osteon cell: --cpu: {}\n", wrong);
    return 2;
  }
  OutputThread output;
  base::InstallInterrupt();
  config::CellConfig cell = config::LoadCell(options.cell, options.tool, {}, options.identified);
  if (!options.plan.empty()) {
    const config::SurgicalPlanConfig plan = config::LoadSurgicalPlan(options.plan);
    if (!options.tool)  // because the controller also begins with the plan's first tool
      cell = config::LoadCell(options.cell,
                              config::ToolChoice{cell.tool_file, plan.plan.tools.front().diameter_m}, {},
                              options.identified);
    UseHandOfPlan(plan.plan, options.hand, config::BoneInWorld(cell, plan.site), plan.site,
                  ReamerOf(plan.plan, cell), cell);
  }
  if (const auto first_port = UseSimulated(cell, options.port); !first_port) {
    fmt::print(stderr, "osteon cell: {}\n", first_port.error());
    return 2;
  }
  hil::CellHostState state;
  CycleReaders readers;
  if (!options.trace.empty()) {
    auto opened = CellTraceWriter::Open(options.trace);
    if (!opened) {
      fmt::print(stderr, "osteon cell: --trace {}\n", opened.error());
      return 2;
    }
    readers.trace = std::move(*opened);
  }
  try {
    hil::CellHostParams params = HostParams(cell);
    params.arm.thread.cpu = params.device_thread.cpu = options.cpu;
    // lock the memory of the whole process: reading a memory page back from disk would take so long that the
    // arm stops
    params.arm.thread.lock_memory = true;
    readers.page = OpenPage(options, cell);
    if (readers.any()) params.arm.cycles = &readers.cycles;
    hil::CellHost host(params, MakeSimulatedCell(cell, options.seconds));
    PrintSimulatedSide(cell);
    PrintIdentified(cell, "cell");
    CellScreen screen(cell);
    const rt::Nanoseconds begun = rt::MonotonicNow();
    while (!base::Interrupted().load()) {
      std::this_thread::sleep_for(kStateInterval);
      state = host.State();
      readers.Pass();
      const std::vector<std::string> lines = screen.Lines(state, rt::ToSeconds(rt::MonotonicNow() - begun));
      for (const std::string& line : lines) fmt::print("osteon cell: {}\n", line);
      if (readers.page) readers.page->Show(state, lines);
      std::fflush(stdout);
    }
    state = host.State();
    host.Stop();  // sends the messages that end the arm's session
    readers.Pass();
  } catch (const std::exception& error) {
    fmt::print(stderr, "osteon cell: {}\n", error.what());
    return 2;
  }
  if (readers.trace)
    if (const auto closed = readers.trace->Close(readers.cycles.dropped()); !closed) {
      fmt::print(stderr, "osteon cell: --trace {}\n", closed.error());
      return 1;
    }
  if (options.json.empty()) return 0;
  if (const auto written = base::WriteText(options.json, ToJson(state, cell.link)); !written) {
    fmt::print(stderr, "osteon cell: {}\n", written.error());
    return 1;
  }
  return 0;
}

}  // namespace osteon::session
