#include "session/run/simulate.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/paced_priority.h"
#include "base/realtime_thread.h"
#include "base/work_folder.h"
#include "base/write_text.h"
#include "io/engine/engine_setup.h"
#include "io/engine/local_engine.h"
#include "io/engine/udp_engine.h"
#include "session/process/exit_code.h"
#include "session/run/engine_token.h"
#include "session/setup/engine_choice.h"
#include "simulation/files/carved_file.h"

namespace osteon::session {
namespace {

constexpr rt::Nanoseconds kCommandWait = 50 * rt::kMillisecond;  // longest wait before Ctrl-C is checked
constexpr double kMaxDt_s = 0.1;  // longest time step of a frame: cutting missed in a stall is not made up

// The contents of the report: the engine that was made last, and counts since the process began.
struct Served {
  std::string engine, device;
  std::uint64_t frames{0}, runs{0};
};

// Returns the carved state as the bytes of its file.
tl::expected<std::vector<std::uint8_t>, std::string> CarvedBytes(const simulation::CuttingEngine& engine,
                                                                 const simulation::Bone& bone) {
  const base::WorkFolder folder("simulate");
  if (folder.path().empty()) return tl::make_unexpected(std::string("cannot make a temporary folder"));
  const std::filesystem::path file = folder.path() / "carved";
  if (const auto written = simulation::WriteCarvedState(file, engine.Snapshot(), bone); !written)
    return tl::make_unexpected(written.error().Text());
  std::ifstream stream(file, std::ios::binary);
  std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(stream), {});
  if (!stream || bytes.empty()) return tl::make_unexpected(file.string() + ": cannot read it back");
  return bytes;
}

// Answers each command with a frame until the run is over, and sends the carved state when the client ends
// the frames. @returns what went wrong; empty: nothing
std::string ServeRun(io::EngineServer& server, simulation::CuttingEngine& engine,
                     const simulation::Bone& bone, Served& served) {
  rt::PacedPriority priority;
  rt::Nanoseconds last_stamp = 0;  // stamp of the newest command that was answered
  bool carved_sent = false;
  while (!base::Interrupted().load()) {
    io::EngineCommand asked;
    const io::EngineEvent event = server.Await(asked, rt::MonotonicNow() + kCommandWait);
    if (event == io::EngineEvent::kGone) return "";
    if (event == io::EngineEvent::kEnd && !carved_sent) {
      carved_sent = true;
      auto bytes = CarvedBytes(engine, bone);
      if (!bytes) return bytes.error();
      server.PutCarved(std::move(*bytes));
    }
    if (event == io::EngineEvent::kEnd) rt::SleepUntil(rt::MonotonicNow() + rt::kMillisecond);
    if (event != io::EngineEvent::kCommand) continue;
    const simulation::ToolCommand& command = asked.command;
    if (command.stamp == last_stamp) continue;
    const rt::Nanoseconds start = rt::MonotonicNow();
    const double since_s = last_stamp == 0 ? 0.0 : rt::ToSeconds(command.stamp - last_stamp);
    last_stamp = command.stamp;
    io::EngineFrame frame;
    frame.spindle_rad_per_s = command.spindle_rad_per_s;
    frame.model = engine.Step({.X_WT = command.X_WT,
                               .spindle_rad_per_s = command.spindle_rad_per_s,
                               .dt_s = std::clamp(asked.dt_s < 0.0 ? since_s : asked.dt_s, 0.0, kMaxDt_s),
                               .stamp = command.stamp});
    const rt::Nanoseconds end = rt::MonotonicNow();
    frame.duration_ns = end - start;
    server.Publish(frame);
    ++served.frames;
    priority.CountWork(end);
    if (frame.model.status == simulation::EngineStatus::kDeviceLost) return "the device is lost";
  }
  return "";
}

// Serves the one run whose shared memory lies in options.local. @returns what went wrong; empty: nothing
std::string ServeLocal(const SimulateOptions& options, Served& served) {
  auto server = io::LocalEngineServer::Open(options.local);
  if (!server) return server.error();
  const auto fail = [&server](std::string why) {
    (*server)->SetFailed(why);
    return why;
  };
  const auto bytes = (*server)->ReadSetup();
  if (!bytes) return fail(bytes.error());
  const auto setup = io::DecodeSetup(*bytes);
  if (!setup) return fail(setup.error());
  const EngineChoice choice = ChooseEngine(options.engine, options.device);
  auto engine = MakeEngine(choice, setup->bone, setup->tool, setup->X_WG, setup->cutting);
  if (!engine) return fail(engine.error());
  served.engine = (*engine)->name();
  served.device = (*engine)->device();
  ++served.runs;
  (*server)->SetRunning(served.engine, served.device);
  if (std::string wrong = ServeRun(**server, **engine, setup->bone, served); !wrong.empty())
    return fail(wrong);
  return "";
}

// Serves one run after the other until Ctrl-C. @returns why the server could not start; empty: it has run
std::string ServeUdp(const SimulateOptions& options, Served& served) {
  io::UdpServerParams params{.address = options.address, .port = options.port};
  if (!options.token_file.empty()) {
    auto token = ReadEngineToken(options.token_file);
    if (!token) return token.error();
    params.token = std::move(*token);
  }
  auto server = io::UdpEngineServer::Open(params);
  if (!server) return server.error();
  const EngineChoice choice = ChooseEngine(options.engine, options.device);
  fmt::print("osteon simulate: the engine, {}, listens on {}:{}\nosteon simulate: Ctrl-C ends it\n",
             choice.engine, options.address, (*server)->port());
  std::fflush(stdout);
  while (!base::Interrupted().load()) {
    const auto bytes = (*server)->AwaitSetup(rt::MonotonicNow() + kCommandWait);
    if (!bytes) continue;
    const auto setup = io::DecodeSetup(*bytes);
    auto engine = setup ? MakeEngine(choice, setup->bone, setup->tool, setup->X_WG, setup->cutting)
                        : tl::make_unexpected(setup.error());
    std::string wrong;
    if (engine) {
      served.engine = (*engine)->name();
      served.device = (*engine)->device();
      ++served.runs;
      fmt::print("osteon simulate: run {}: {}, {} balls\n", served.runs, setup->bone.name,
                 setup->bone.balls.size());
      std::fflush(stdout);
      (*server)->SetRunning(served.engine, served.device);
      wrong = ServeRun(**server, **engine, setup->bone, served);
    } else {
      wrong = engine.error();
    }
    if (!wrong.empty()) {
      (*server)->SetFailed(wrong);
      fmt::print(stderr, "osteon simulate: {}\n", wrong);
    }
    (*server)->ResetSession();
  }
  return "";
}

}  // namespace

int RunSimulate(const SimulateOptions& options) {
  base::InstallInterrupt();
  rt::NameThread("simulation");
  Served served;
  const bool local = !options.local.empty();
  const std::string wrong = local ? ServeLocal(options, served) : ServeUdp(options, served);
  if (!options.json.empty()) {
    const nlohmann::ordered_json report{{"schema", "osteon.simulate/1"}, {"engine", served.engine},
                                        {"device", served.device},       {"runs", served.runs},
                                        {"frames", served.frames},       {"error", wrong}};
    if (const auto written = base::WriteText(options.json, base::JsonText(report)); !written)
      return Fail("simulate", written.error(), kFailed);
  }
  return wrong.empty() ? 0 : Fail("simulate", wrong, local ? kFailed : kBadInput);
}

}  // namespace osteon::session
