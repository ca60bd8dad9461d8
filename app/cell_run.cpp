#include "app/cell_run.h"

#include <chrono>
#include <memory>
#include <optional>

#include "app/build_name.h"
#include "app/chart_files.h"
#include "app/recorded_config.h"
#include "app/simulation_thread.h"
#include "control/rt/clock.h"
#include "io/fri/fri_link.h"

namespace osteon::app {
namespace {

constexpr int kFrameTicks =
    2;  // virtual time: ticks from one frame to the next, and from its pose to its model
constexpr double kVirtualGiveUp_s = 30.0;  // without COMMANDING_ACTIVE, or without rest after the end

hil::SimulatedCell MakeCell(const CellSetup& setup, double seconds) {
  hil::ScriptParams script = setup.config.script;
  std::visit([seconds](auto& s) { s.seconds = seconds; }, script);
  return {setup.config.simulated, MakeScript(script)};
}

rt::Nanoseconds UtcNow() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count();
}

void RecordFaults(io::Recorder& recorder, rt::Nanoseconds stamp, safety::FaultSet faults,
                  safety::FaultSet& known) {
  for (std::uint32_t bit = 1; bit != 0; bit <<= 1) {
    const auto fault = static_cast<safety::Fault>(bit);
    if (!faults.Has(fault) || known.Has(fault)) continue;
    known.Latch(fault);
    const safety::FaultText text = safety::Describe(fault);
    recorder.PushEvent(stamp, std::string("fault: ") + text.name + "; " + text.reaction);
  }
}

CellRunResult RunWall(const CellSetup& setup, simulation::CuttingEngine& engine, FrameRunner& runner,
                      io::FriLink& link, io::Recorder& recorder, const CellRunParams& params) {
  CellRunResult result;
  control::ServoLoop loop = MakeServoLoop(setup.config);
  rt::LatestValue<simulation::ContactModel> models;
  rt::LatestValue<simulation::ToolCommand> commands;
  control::RunServoResult servo;
  {
    SimulationThread simulation(runner, commands, models, recorder);
    hil::SimulatedCellThread arm({.client_address = setup.config.fri.host, .client_port = link.port()},
                                 MakeCell(setup, params.seconds));
    std::atomic<bool> done{false};
    std::thread servo_thread([&] {
      servo = RunServo(
          loop, link, arm.sensor(), models, commands, recorder,
          {.deadline_s = 5.0 * setup.config.servo.period_s, .seconds = params.seconds, .stop = params.stop});
      arm.Stop();  // at once: a client that is gone is no loss on the arm's books
      done.store(true);
    });
    while (!done.load()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      if (params.progress) params.progress(arm.statistics().cell.cell_time_s);
    }
    servo_thread.join();
    simulation.Stop();
    result.cell = arm.statistics().cell;
  }
  result.end = servo.end;
  if (servo.end == control::RunEnd::kNeverActive) result.diagnosis = link.session().Diagnosis();
  result.faults = servo.faults;
  result.statistics = servo.statistics;
  result.realtime = servo.realtime;
  safety::FaultSet known;
  RecordFaults(recorder, rt::MonotonicNow(), servo.faults, known);
  result.after = engine.Snapshot();
  return result;
}

CellRunResult RunVirtual(const CellSetup& setup, simulation::CuttingEngine& engine, FrameRunner& runner,
                         io::Recorder& recorder, const CellRunParams& params) {
  CellRunResult result;
  control::ServoLoop loop = MakeServoLoop(setup.config);
  hil::SimulatedCell cell = MakeCell(setup, params.seconds);
  io::FriSession session(setup.config.fri.session);
  control::ArmState state;
  control::ArmCommand command;
  simulation::ContactModel model;
  std::optional<simulation::FrameRecord> pending;
  safety::FaultSet known;
  bool stopped_by_user = false;

  const auto period = static_cast<rt::Nanoseconds>(cell.period_s() * 1e9);
  const auto wanted = static_cast<std::uint64_t>(params.seconds / cell.period_s() + 0.5);
  const auto patience = static_cast<std::int64_t>(kVirtualGiveUp_s / cell.period_s());
  std::int64_t since_progress = 0;
  for (std::int64_t tick = 1; loop.phase() != control::Phase::kStopped && since_progress < patience; ++tick) {
    const rt::Nanoseconds now = tick * period;
    const auto message = cell.Step(now);
    const bool accepted = !message.empty() && session.Accept(message, now, state) == io::FriAccept::kAccepted;
    const auto received = accepted ? control::ReceiveResult::kOk : control::ReceiveResult::kTimeout;

    // the frame of two ticks ago has arrived
    if (tick % kFrameTicks == 0 && pending) {
      model = pending->model;
      pending->stamp = now;
      recorder.PushFrame(*pending);
      runner.RecordEvents(recorder, now);
      pending.reset();
    }
    recorder.Push(loop.Tick(state, received, cell.force(), model, now, command));
    if (const auto answer = session.Answer(command); accepted && !answer.empty()) cell.Receive(answer);
    if (tick % kFrameTicks == 0) pending = runner.Run(loop.tool_command());

    RecordFaults(recorder, now, loop.faults(), known);
    stopped_by_user = params.stop && params.stop->load();
    const std::uint64_t active = loop.statistics().active_ticks;
    since_progress = active > 0 && active < wanted && !stopped_by_user ? 0 : since_progress + 1;
    if (active >= wanted || stopped_by_user) loop.RequestStop();
    if (tick % 100 == 0) {
      recorder.Drain();
      if (params.progress) params.progress(cell.state().cell_time_s);
    }
  }
  result.faults = loop.faults();
  result.statistics = loop.statistics();
  result.end = result.faults.Any()                       ? control::RunEnd::kFault
               : stopped_by_user                         ? control::RunEnd::kStopFlag
               : result.statistics.active_ticks < wanted ? control::RunEnd::kNeverActive
                                                         : control::RunEnd::kSeconds;
  if (result.end == control::RunEnd::kNeverActive) result.diagnosis = session.Diagnosis();
  result.cell = cell.state();
  result.after = engine.Snapshot();
  return result;
}

}  // namespace

tl::expected<CellRunResult, std::string> RunCell(const CellSetup& setup, simulation::CuttingEngine& engine,
                                                 const CellRunParams& params) {
  const simulation::ApexDepth depth(setup.bone, setup.config.tool.tool);
  simulation::SceneWatch watch(*setup.solid, setup.bone, setup.config.tool.tool, setup.config.scene.events);
  FrameRunner runner(engine, depth, watch, setup.X_WG);
  // what may be refused comes first: an earlier run's recording is only overwritten by a run
  std::unique_ptr<io::FriLink> link;
  if (!params.virtual_time) {
    auto opened = io::FriLink::Open({.bind_address = setup.config.fri.host,
                                     .port = setup.config.fri.port,
                                     .session = setup.config.fri.session});
    if (!opened) return tl::make_unexpected(opened.error());
    link = std::move(*opened);
  }
  if (const auto folder = params.recording.parent_path(); !folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return tl::make_unexpected(folder.string() + ": cannot make the folder: " + error.message());
  }
  auto recorder = io::Recorder::Open({.path = params.recording, .writer_thread = !params.virtual_time},
                                     {.stamp = params.virtual_time ? 0 : rt::MonotonicNow(),
                                      .version = OSTEON_VERSION,
                                      .engine = engine.name(),
                                      .device = engine.device(),
                                      .scene = setup.bone.name,
                                      .tool = setup.config.tool.tool.name,
                                      .force_limit_N = setup.config.servo.wrench.max_force_N,
                                      .config_text = setup.config_text,
                                      .config = setup.config_source,
                                      .utc = params.virtual_time ? 0 : UtcNow(),
                                      .build = BuildName(),
                                      .machine = MachineName()});
  if (!recorder) return tl::make_unexpected(recorder.error());

  CellRunResult result = params.virtual_time ? RunVirtual(setup, engine, runner, **recorder, params)
                                             : RunWall(setup, engine, runner, *link, **recorder, params);
  const auto counts = (*recorder)->Close();
  if (!counts) return tl::make_unexpected(counts.error());
  result.recording = *counts;
  result.events = runner.events();
  result.least_wall_m = watch.least_wall_m();
  return result;
}

}  // namespace osteon::app
