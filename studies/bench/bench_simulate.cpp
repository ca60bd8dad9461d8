#include "studies/bench/bench_simulate.h"

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/paced_priority.h"
#include "base/phase_progress.h"
#include "base/realtime_thread.h"
#include "base/write_text.h"
#include "io/net/free_ports.h"
#include "session/process/exit_code.h"
#include "session/run/remote_engine.h"
#include "session/setup/cell_setup.h"
#include "simulation/fidelity/frame_workload.h"

namespace osteon::studies {
namespace {

// The connections to the engine, in the order of their measurement.
constexpr std::array<std::string_view, 3> kWays{"thread", "shared memory", "UDP"};
constexpr rt::Nanoseconds kTick = rt::kMillisecond;         // the loop's period
constexpr rt::Nanoseconds kPoll = 50'000;                   // from one poll for a command to the next
constexpr rt::Nanoseconds kUdpPatience = 30 * rt::kSecond;  // longest wait until the engine's process listens
constexpr int kWarmUp = 200;                                // ticks of a round that do not count
constexpr rt::Nanoseconds kModelPollInterval = 10'000;      // from one poll for a model to the next
constexpr rt::Nanoseconds kLeftForTick = 50'000;            // time before a tick in which there is no poll
constexpr double kPressed_m = 1e-3;                         // depth of the head below the cup's floor
constexpr double kDrift_m_per_s = 1e-4;                     // motion along x, so that no two poses are alike

double Microseconds(rt::Nanoseconds time) { return 1e-3 * static_cast<double>(time); }

// The engine as a thread, polled as SimulationThread does.
class ThreadEngine {
 public:
  explicit ThreadEngine(simulation::CuttingEngine& engine) : engine_(engine), thread_([this] { Loop(); }) {}
  ~ThreadEngine() {
    stop_.store(true);
    thread_.join();
  }
  ThreadEngine(const ThreadEngine&) = delete;
  ThreadEngine& operator=(const ThreadEngine&) = delete;
  [[nodiscard]] control::SimulationPort& port() { return port_; }

 private:
  void Loop() {
    rt::PacedPriority priority;
    rt::Nanoseconds done = 0;
    while (!stop_.load()) {
      const simulation::ToolCommand command = commands_.Load();
      const rt::Nanoseconds start = rt::MonotonicNow();
      if (command.stamp == done) {
        rt::SleepUntil(start + kPoll);
        continue;
      }
      const double dt_s = done == 0 ? 0.0 : std::min(0.1, rt::ToSeconds(command.stamp - done));
      done = command.stamp;
      models_.Store(engine_.Step({.X_WT = command.X_WT,
                                  .spindle_rad_per_s = command.spindle_rad_per_s,
                                  .dt_s = dt_s,
                                  .stamp = command.stamp}));
      priority.CountWork(rt::MonotonicNow());
    }
  }

  simulation::CuttingEngine& engine_;
  rt::LatestValue<simulation::ContactModel> models_;
  rt::LatestValue<simulation::ToolCommand> commands_;
  control::ThreadSimulation port_{models_, commands_};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// The tool's pose with its head kPressed_m deep in the site's floor.
Pose PressedPose(const session::CellSetup& setup) {
  Pose X_WT = setup.config.start.X_WT;
  const Vector3 axis_W = (setup.X_WG.linear() * Vector3(setup.bone.site.axis)).normalized();
  const simulation::ToolBall* head = simulation::CuttingHead(setup.config.tool.tool);
  const double room_m = head ? setup.bone.site.radius_m - head->radius_m : 0.0;
  X_WT.translation() -= (setup.config.start.height_m + room_m + kPressed_m) * axis_W;
  return X_WT;
}

// Measured times: one value for each tick that counts.
struct Times {
  std::vector<double> age_us;   ///< age of the contact model that a tick uses
  std::vector<double> back_us;  ///< time from a tick's command until its model can be taken
};

// Runs ticks at 1 kHz, and polls for the contact model between the ticks.
Times Tick(control::SimulationPort& port, const Pose& X_WT, double spindle_rad_per_s, int ticks) {
  Times times;
  std::thread loop([&] {  // in a thread of its own, so that the real-time priority ends with it
    rt::SetUpRealtimeThread({.priority = 80});
    rt::Nanoseconds next = rt::MonotonicNow();
    for (int tick = -kWarmUp; tick < ticks && !base::Interrupted().load(); ++tick) {
      rt::SleepUntil(next += kTick);
      const rt::Nanoseconds now = rt::MonotonicNow();
      const simulation::ContactModel& model = port.Load();
      if (tick >= 0 && model.frame > 0) times.age_us.push_back(Microseconds(now - model.pose_stamp));
      Pose X = X_WT;
      X.translation().x() += kDrift_m_per_s * rt::ToSeconds(tick * kTick);
      port.Store({.X_WT = X, .spindle_rad_per_s = spindle_rad_per_s, .stamp = now});
      for (rt::Nanoseconds at = now; at < next + kTick - kLeftForTick;) {
        rt::SleepUntil(at += kModelPollInterval);
        if (port.Load().pose_stamp < now) continue;
        if (tick >= 0) times.back_us.push_back(Microseconds(rt::MonotonicNow() - now));
        break;
      }
    }
  });
  loop.join();
  return times;
}

// Runs ticks as Tick does, with an engine in another process. A thread receives the engine's models
// meanwhile.
Times TickRemote(session::RemoteEngine& engine, const Pose& X_WT, double spindle_rad_per_s, int ticks) {
  std::atomic<bool> stop{false};
  std::thread receiver([&] {
    rt::PacedPriority priority;
    io::EngineFrame frame;
    while (!stop.load()) static_cast<void>(engine.client().AwaitFrame(frame, rt::MonotonicNow() + 5 * kTick));
  });
  Times times = Tick(engine.client(), X_WT, spindle_rad_per_s, ticks);
  stop.store(true);
  receiver.join();
  return times;
}

// Measures one connection in one round. If it cannot, `wrong` gets the reason.
// @param way  index in kWays
Times Measure(std::size_t way, session::CellSetup& setup, const session::EngineChoice& choice, int ticks,
              std::string& wrong) {
  const Pose X_WT = PressedPose(setup);
  const double spindle = setup.config.tool.spindle_rad_per_s;
  if (way == 0) {
    auto engine = session::MakeEngine(setup, choice);
    if (!engine) return wrong = engine.error(), Times{};
    ThreadEngine thread(**engine);
    return Tick(thread.port(), X_WT, spindle, ticks);
  }
  setup.config.engine_process.emplace();
  std::unique_ptr<base::ChildProcess> listener;
  if (way == 2) {
    const auto port = io::FindFreePorts(1);
    if (!port) return wrong = port.error(), Times{};
    setup.config.engine_process->host = "127.0.0.1";
    setup.config.engine_process->port = *port;
    auto started = base::ChildProcess::Start(
        {.words = {"simulate", "--listen", fmt::format("127.0.0.1:{}", *port), "--engine", choice.engine},
         .program = session::OsteonProgram()});
    if (!started) return wrong = started.error(), Times{};
    listener = std::move(*started);
  }
  const rt::Nanoseconds give_up = rt::MonotonicNow() + kUdpPatience;
  for (;;) {
    auto engine = session::RemoteEngine::Open(setup, choice, "");
    if (engine) return TickRemote(**engine, X_WT, spindle, ticks);
    if (way == 1 || rt::MonotonicNow() > give_up) return wrong = engine.error(), Times{};
  }
}

}  // namespace

int RunBenchSimulate(const BenchSimulateOptions& options) {
  auto setup = session::PrepareCell(options.config_root / "cells" / "demo.yaml", {});
  if (!setup) return session::Fail("bench simulate", setup.error(), session::kFailed);
  session::PackAsScene(*setup);
  const session::EngineChoice choice = session::ChooseEngine(options.engine, options.device);
  base::InstallInterrupt();
  std::array<Times, kWays.size()> times;
  base::PhaseProgress progress("osteon bench simulate", options.rounds * static_cast<int>(kWays.size()));
  for (int round = 0; round < options.rounds && !base::Interrupted().load(); ++round)
    for (std::size_t way = 0; way < kWays.size() && !base::Interrupted().load(); ++way) {
      progress.BeginPhase(fmt::format("{} {} of {}", kWays[way], round + 1, options.rounds));
      std::string wrong;
      const Times more = Measure(way, *setup, choice, options.ticks, wrong);
      if (!wrong.empty()) {
        progress.Done();
        return session::Fail("bench simulate", wrong, session::kFailed);
      }
      const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      append(times[way].age_us, more.age_us);
      append(times[way].back_us, more.back_us);
    }
  progress.Done();
  nlohmann::ordered_json json{{"schema", "osteon.bench_simulate/1"},
                              {"engine", choice.engine},
                              {"ticks", options.ticks},
                              {"rounds", options.rounds},
                              {"ways", nlohmann::json::array()}};
  fmt::print("us{:<18}{:>9}{:>9}{:>9}{:>9}{:>12}\n", "", "p50", "p95", "p99", "max", "added p50");
  for (std::size_t way = 0; way < kWays.size(); ++way) {
    nlohmann::ordered_json row{{"by", kWays[way]}};
    for (const auto& [name, of] : {std::pair{"age", &Times::age_us}, {"back", &Times::back_us}}) {
      if ((times[way].*of).empty()) continue;
      const simulation::TimeFigures t = simulation::FiguresOf(times[way].*of);
      const std::vector<double>& thread = times.front().*of;
      const double added_us = thread.empty() ? 0.0 : t.p50_us - simulation::FiguresOf(thread).p50_us;
      fmt::print("{:<14}{:<6}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>12.1f}\n", kWays[way], name, t.p50_us,
                 t.p95_us, t.p99_us, t.max_us, added_us);
      row[name] = {{"count", (times[way].*of).size()},
                   {"p50_us", t.p50_us},
                   {"p95_us", t.p95_us},
                   {"p99_us", t.p99_us},
                   {"max_us", t.max_us},
                   {"added_p50_us", added_us}};
    }
    json["ways"].push_back(std::move(row));
  }
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, base::JsonText(json)); !written)
      return session::Fail("bench simulate", written.error(), session::kFailed);
  return base::Interrupted().load() ? base::kExitInterrupted : 0;
}

}  // namespace osteon::studies
