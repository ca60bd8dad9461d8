#include "session/run/cell_run.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "base/clock.h"
#include "control/loop/rest_time.h"
#include "hil/impaired_cell.h"
#include "io/devices/wired_devices.h"
#include "session/foxglove/recorded_topics.h"
#include "session/gains/gains_watch.h"
#include "session/planning/recorded_packing.h"
#include "session/procedure/bone_history.h"
#include "session/procedure/procedure_session.h"
#include "session/run/arm_connection.h"
#include "session/run/fault_events.h"
#include "session/run/frame_receiver.h"
#include "session/run/frame_runner.h"
#include "session/run/remote_engine.h"
#include "session/run/run_end.h"
#include "session/run/simulated_cell_run.h"
#include "session/run/simulated_setup.h"
#include "session/run/simulation_thread.h"
#include "session/run/start_path.h"
#include "session/run/start_watch.h"
#include "session/run/virtual_devices.h"
#include "session/setup/build_name.h"
#include "session/setup/recorded_config.h"
#include "session/summary/chart_files.h"
#include "session/summary/deflection_events.h"
#include "session/summary/limit_rows.h"

namespace osteon::session {
namespace {

constexpr double kVirtualGiveUp_s = 30.0;  // longest wait for COMMANDING_ACTIVE, or for rest after the stop

constexpr std::chrono::milliseconds kSupervisionPeriod{10};  // time between two checks of a run

constexpr int kPacedTicks = 10;  // virtual time: a run with a real-time factor may wait after as many ticks

rt::Nanoseconds UtcNow() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count();
}

// The connections of a run in wall time.
struct CellConnections {
  std::optional<ArmConnection> arm;
  std::unique_ptr<io::WiredDevices> devices;
  std::unique_ptr<CellProcess> cell;  // the simulated cell; null: this run started none
  FaultEvents* faults{nullptr};       // fault events of the run's recording
};

// Opens the connections to arm and devices; the cell's process is started later.
tl::expected<CellConnections, std::string> OpenConnections(const CellSetup& setup) {
  CellConnections connections;
  // with a guard, the messages come from the guard: accept the first sender instead of the arm's address
  auto arm = ArmConnection::Open(setup.config.link, setup.config.guard ? "" : setup.config.link.arm_host);
  if (!arm) return tl::make_unexpected(arm.error());
  connections.arm = std::move(*arm);
  auto devices = io::WiredDevices::Open(setup.config.devices);
  if (!devices) return tl::make_unexpected(devices.error());
  connections.devices = std::move(*devices);
  return connections;
}

// Passes each of the operator's requests to the loop once, and reports it as a notice.
void ApplyRequests(const CellRunParams& params, control::ServoLoop& loop) {
  if (!params.requests) return;
  const bool pause = params.requests->pause.exchange(false), resume = params.requests->resume.exchange(false),
             recover = params.requests->recover.exchange(false);
  if (recover) loop.RequestRecovery();
  if (resume && params.procedure)
    params.procedure->RequestResume();  // the session first checks that the tool is clear of bone
  else if (resume)
    loop.RequestResume();
  if (pause) loop.RequestPause();
  if (params.notice && (pause || resume || recover))
    params.notice(pause ? "a pause was asked for" : resume ? "asked to go on" : "a recovery was asked for");
}

// Gives the loop the tools of a procedure, if there is one.
void SetTools(const CellRunParams& params, control::ServoLoop& loop) {
  if (params.procedure) SetTools(params.procedure->tools(), params.procedure->first_tool(), loop);
}

// Passes the recorded ticks to a procedure's session as well as to the live view.
class ProcedureSink final : public io::RecordSink {
 public:
  explicit ProcedureSink(const CellRunParams& params) : live_(params.live), procedure_(params.procedure) {}
  /// The sink that the recorder is given; null: there is neither session nor live view.
  [[nodiscard]] io::RecordSink* sink() { return procedure_ ? this : live_; }
  void TakeTick(const control::TickRecord& tick) override {
    procedure_->OnTick(tick);
    if (live_) live_->TakeTick(tick);
  }
  void TakeFrame(const simulation::FrameRecord& frame) override {
    if (live_) live_->TakeFrame(frame);
  }
  void TakeEvent(const io::RecordedEvent& event) override {
    if (live_) live_->TakeEvent(event);
  }

 private:
  io::RecordSink* live_;
  ProcedureSession* procedure_;
};

// Time for which the arm is still answered and recorded after it has come to rest [s]. It is 0 if the arm's
// program can be asked to end: the program is then asked at once, before a PLC switches off the arm's power.
double AtRest_s(const CellSetup& setup, const CellRunParams& params) {
  return CanRequestStop(setup.config.link) ? 0.0 : params.at_rest_s;
}

// Runs the cell in wall time: the servo loop and the frames in threads, supervised by this one.
tl::expected<CellRunResult, CellRunError> RunWall(const CellSetup& setup, FrameRunner& runner,
                                                  CellConnections& connections, io::Recorder& recorder,
                                                  const CellRunParams& params) {
  CellRunResult result;
  // the second loop computes each tick again and is compared with the first, so that an error of the computer
  // is found
  control::ServoLoop loop = MakeServoLoop(setup.config), second = MakeServoLoop(setup.config);
  SetTools(params, loop);
  SetTools(params, second);
  rt::LatestValue<simulation::ContactModel> models;
  rt::LatestValue<simulation::ToolCommand> commands;
  control::ThreadSimulation own_simulation(models, commands);
  control::SimulationPort& simulation_port =
      params.remote ? static_cast<control::SimulationPort&>(params.remote->client()) : own_simulation;
  control::RunServoResult servo;
  bool cell_died = false, engine_died = false;
  StartWatch start(setup, loop);
  GainsWatch gains(params.gains, setup.config, loop, params.notice, params.gains_panel);
  {
    std::optional<SimulationThread> simulation;
    std::optional<FrameReceiver> receiver;
    if (params.remote)
      receiver.emplace(runner, params.remote->client(), recorder);
    else
      simulation.emplace(runner, commands, models, recorder);
    std::atomic<bool> done{false}, stop{false};
    std::atomic<double> rendered_s{0.0};
    control::RunServoParams servo_params{.deadline_s = kArmDeadlinePeriods * setup.config.servo.period_s,
                                         .seconds = params.seconds,
                                         .give_up_s = params.wait_s,
                                         .at_rest_s = AtRest_s(setup, params),
                                         .recoveries = params.recoveries,
                                         .hold_at_fault = params.hold_at_fault,
                                         .standing = &start.standing(),
                                         .second = &second,
                                         .rendered_s = &rendered_s,
                                         .stop = &stop};
    servo_params.thread.cpu = params.cpu;
    const auto supervise = [&] {
      cell_died |= !done.load() && connections.cell && connections.cell->Ended();
      if (params.remote && !engine_died && !params.remote->DescribeEnd().empty()) {
        engine_died = true;  // the servo loop stops when the model gets too old
        if (params.notice) params.notice("the engine's process has ended: " + params.remote->DescribeEnd());
        recorder.PushEvent(rt::MonotonicNow(),
                           "the engine's process has ended: " + params.remote->DescribeEnd());
      }
      gains.Poll(rt::ToSeconds(rt::MonotonicNow()));
      ApplyRequests(params, loop);
      if (params.procedure) params.procedure->Poll(loop);
      if (rendered_s.load() == 0.0) start.Poll();  // a recovery starts from the arm's present position
      if (cell_died || !start.why_not().empty() || PollStop(params)) stop.store(true);
      if (params.progress) params.progress(rendered_s.load());
    };
    std::thread servo_thread([&] {
      rt::NameThread("servo");
      servo = RunServo(loop,
                       {.link = connections.arm->link(),
                        .devices = *connections.devices,
                        .simulation = simulation_port,
                        .recorder = recorder},
                       servo_params);
      connections.arm->EndSession();
      // Ask at once, so that the arm does not count the end of this process as a lost client.
      if (connections.cell) connections.cell->AskToEnd();
      done.store(true);
    });
    while (!done.load()) {
      std::this_thread::sleep_for(kSupervisionPeriod);
      if (!result.internal_error.empty()) continue;  // after an internal error, wait until the arm has braked
      try {
        supervise();
      } catch (const std::exception& error) {  // the arm moves and must still come to rest
        result.internal_error = error.what();
        stop.store(true);
      }
    }
    servo_thread.join();
    if (simulation) simulation->Stop();
    if (receiver) receiver->Stop();
    const std::string& wrong = simulation ? simulation->error() : receiver->error();
    if (!wrong.empty()) result.internal_error = "simulation: " + wrong;
  }
  // the input was valid, but the path from the arm's position to the start is not free
  if (!start.why_not().empty())
    return tl::make_unexpected(
        CellRunError{.what = start.why_not() + " (a simulated cell: start it anew)", .begun = true});
  if (cell_died && servo.statistics.active_ticks == 0)
    return tl::make_unexpected(CellRunError{.what = "the simulated cell has ended by itself", .begun = true});
  result.end = servo.end;
  const std::string arm = connections.arm->Diagnosis();
  AddDiagnosis(result, connections.cell ? arm : DescribeMissingArm(arm, setup.config.guard, loop.permits()),
               connections.devices->Diagnosis(), loop.permits());
  if (connections.cell) result.cell_report = connections.cell->End();
  result.faults = servo.faults;
  result.statistics = servo.statistics;
  result.servo_thread = servo.thread;
  result.recovered = servo.recovered;
  result.operator_recoveries = servo.operator_recoveries;
  result.cleared = servo.cleared;
  // also record faults that appear in no tick's record
  connections.faults->Record(recorder, rt::MonotonicNow(), servo.faults.bits());
  RecordEnd(recorder, rt::MonotonicNow(), result, params.seconds);
  return result;
}

// Asks the arm's program to end the session, if the protocol can, and steps the cell until it has ended.
// ArmConnection::EndSession() does the same in wall time.
void EndSession(ArmProtocolSession& session, hil::ImpairedCell& cell, rt::Nanoseconds period) {
  if (!session.RequestStop()) return;
  control::ArmState state;
  rt::Nanoseconds now = cell.state().stamp;
  for (const rt::Nanoseconds end = now + kMaxEndDelay; now < end;) {
    bool accepted = false;
    cell.Step(now += period, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
      accepted |= session.Accept(message, arrival, state);
    });
    if (cell.state().session == control::SessionState::kIdle) return;
    if (accepted) cell.Receive(session.Answer({}));
  }
}

// Runs the cell in virtual time: arm, devices, loop and frames in lockstep, tick by tick.
tl::expected<CellRunResult, CellRunError> RunVirtual(const CellSetup& setup, FrameRunner& runner,
                                                     io::Recorder& recorder, const CellRunParams& params) {
  CellRunResult result;
  control::ServoLoop loop = MakeServoLoop(setup.config);
  SetTools(params, loop);
  hil::ImpairedCell cell(MakeSimulatedCell(setup.config, params.seconds), setup.config.injections);
  const kinematics::JointVector q_first =
      Eigen::Map<const kinematics::JointVector>(setup.config.simulated.q_start.data());
  if (const std::string why = ValidateStartPath(setup, q_first); !why.empty())
    return tl::make_unexpected(CellRunError{.what = why});
  auto devices = VirtualDevices::Make(setup.config);
  if (!devices) return tl::make_unexpected(CellRunError{.what = devices.error()});
  ArmProtocolSession session(setup.config.link);
  GainsWatch gains(params.gains, setup.config, loop, params.notice, params.gains_panel);
  control::ArmState state;
  control::ArmCommand command;
  simulation::ContactModel model;
  std::optional<simulation::FrameRecord> pending;  // computed, but not visible to the loop yet
  FaultEvents faults;
  bool stopped_by_user = false;

  const auto period = static_cast<rt::Nanoseconds>(cell.period_s() * 1e9);
  const auto frame_ticks = std::max<std::int64_t>(1, std::llround(params.frame_s / cell.period_s()));
  const auto wanted_ticks = static_cast<std::uint64_t>(params.seconds / cell.period_s() + 0.5);
  const auto max_idle_ticks = static_cast<std::int64_t>(kVirtualGiveUp_s / cell.period_s());
  std::int64_t idle_ticks = 0;  // ticks in a row without rendering or a pause, or since the requested end
  std::uint64_t active_before = 0, held_ticks = 0;  // COMMANDING_ACTIVE ticks: so far; during holds
  bool recovering = false, stopping = false;        // a recovery, or the end of the run, was requested
  control::RestTime rest(static_cast<rt::Nanoseconds>(std::llround(AtRest_s(setup, params) * 1e9)));
  rt::Nanoseconds go_on = rt::MonotonicNow();  // with a real-time factor: when the run last had to go on
  // whether the run waits, after a fault, for an operator's request for recovery
  const auto holds = [&] {
    return params.hold_at_fault && !stopping && safety::AllowsRecovery(loop.faults());
  };
  const auto is_over = [&](rt::Nanoseconds now) {
    return !recovering && !holds() && loop.phase() == control::Phase::kStopped &&
           rest.IsOver(loop.state(), now);
  };
  for (std::int64_t tick = 1; !is_over((tick - 1) * period) && idle_ticks < max_idle_ticks; ++tick) {
    const rt::Nanoseconds now = tick * period;
    cell.cell().SetPower((*devices)->power());
    bool accepted = false;
    cell.Step(now, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
      accepted |= session.Accept(message, arrival, state);
    });
    if (cell.state().active_once) (*devices)->StartSchedule(now);
    (*devices)->SetLoad(cell.cell().force().F_S);
    const auto received = accepted ? control::ReceiveResult::kOk : control::ReceiveResult::kTimeout;

    // the previous frame becomes visible to the loop
    if (tick % frame_ticks == 0 && pending) {
      model = pending->model;
      pending->stamp = now;
      recorder.PushFrame(*pending);
      if (params.frame_us) runner.AdaptResolution(*pending, params.frame_us(*pending));
      runner.RecordEvents(recorder, now);
      pending.reset();
    }
    gains.Poll(rt::ToSeconds(now));
    ApplyRequests(params, loop);
    if (params.procedure) params.procedure->Poll(loop);
    const control::CellReadings readings = (*devices)->Exchange(loop.cell_commands(), now);
    const bool could_recover = loop.CanRecover();
    const safety::FaultSet faults_before = loop.faults();
    const control::TickRecord record = loop.Tick(
        {.state = state, .received = received, .readings = readings, .model = model, .now = now}, command);
    if (could_recover && record.input.recover) {
      result.cleared.Latch(faults_before);
      faults.Forget();
      if (!recovering) ++result.operator_recoveries;
    }
    recorder.Push(record);
    if (params.ticked) params.ticked(record, model);
    recovering = false;
    if (const auto answer = session.Answer(command); accepted && !answer.empty()) cell.Receive(answer);
    // compute no frame before a pose is known: it would drag the proxy through the bone to the first real
    // pose
    if (tick % frame_ticks == 0 && loop.tool_command().stamp != 0) pending = runner.Run(loop.tool_command());

    faults.Record(recorder, now, loop.faults().bits());
    if (loop.CanRecover() && result.recovered < params.recoveries &&
        loop.statistics().active_ticks - held_ticks < wanted_ticks) {
      ++result.recovered;
      loop.RequestRecovery();
      recovering = true;
      continue;
    }
    if (loop.phase() != control::Phase::kStopped) stopped_by_user = PollStop(params);
    if (holds()) held_ticks = loop.statistics().active_ticks - active_before;
    const std::uint64_t active = loop.statistics().active_ticks - held_ticks;
    const bool progress = active > active_before || loop.state() == safety::CellState::kPaused;
    active_before = active;
    idle_ticks = progress && active < wanted_ticks && !stopped_by_user ? 0 : idle_ticks + 1;
    if (active >= wanted_ticks || stopped_by_user) {
      stopping = true;
      loop.RequestStop();
    }
    if (tick % 100 == 0) {
      recorder.Drain();
      if (params.progress) params.progress(cell.state().cell_time_s);
    }
    if (params.real_time_factor > 0.0 && tick % kPacedTicks == 0) {
      const double paced_ns = static_cast<double>(kPacedTicks * period) / params.real_time_factor;
      const rt::Nanoseconds real = rt::MonotonicNow();
      go_on = std::max(go_on + static_cast<rt::Nanoseconds>(paced_ns), real);
      std::this_thread::sleep_for(std::chrono::nanoseconds(go_on - real));
    }
  }
  EndSession(session, cell, period);
  result.faults = loop.faults();
  result.statistics = loop.statistics();
  result.end = result.faults.Any()            ? control::RunEnd::kFault
               : stopped_by_user              ? control::RunEnd::kStopFlag
               : active_before < wanted_ticks ? control::RunEnd::kNeverActive
                                              : control::RunEnd::kSeconds;
  AddDiagnosis(result, session.Diagnosis(), (*devices)->Diagnosis(), loop.permits());
  RecordEnd(recorder, cell.state().stamp, result, params.seconds);
  result.cell_report =
      ToJson(hil::CellHostState{.arm = {.cell = cell.state(), .thread = {}, .wires = cell.counters()},
                                .devices = (*devices)->counters(),
                                .plc = (*devices)->plc(),
                                .plc_counters = {},
                                .tool_speed_rad_per_s = (*devices)->tool_speed_rad_per_s()},
             setup.config.link);
  return result;
}

}  // namespace

tl::expected<CellRunResult, CellRunError> RunCell(const CellSetup& setup, simulation::CuttingEngine& engine,
                                                  const CellRunParams& params) {
  const simulation::Tool& tool =
      params.procedure
          ? params.procedure->tools()[static_cast<std::size_t>(params.procedure->first_tool())].tool
          : setup.config.tool.tool;
  const simulation::ApexDepth depth(setup.bone, tool);
  simulation::SceneWatch watch(setup.solid.get(), setup.bone, tool, setup.config.scene.events);
  FrameRunner runner(engine, depth, watch, setup.X_WG, params.adaptive_resolution);
  runner.SetNotice(params.notice);
  runner.SetSurface(params.surface);
  runner.SetObserver(params.procedure);
  // do the checks that may refuse the run first, because a refused run must not overwrite an earlier
  // recording
  CellConnections connections;
  if (!params.virtual_time) {
    auto opened = OpenConnections(setup);
    if (!opened) return tl::make_unexpected(CellRunError{.what = opened.error()});
    connections = std::move(*opened);
  }
  if (const auto folder = params.recording.parent_path(); !folder.empty()) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error)
      return tl::make_unexpected(
          CellRunError{.what = folder.string() + ": cannot make the folder: " + error.message()});
  }
  if (params.make_room)
    if (std::string wrong = params.make_room(); !wrong.empty())
      return tl::make_unexpected(CellRunError{.what = std::move(wrong)});
  ProcedureSink sink(params);
  DeflectionSink deflections(sink.sink());
  FaultEvents faults;
  FaultSink faults_seen(deflections, faults);
  std::optional<RecordedBoneParams> bone;
  if (params.bone_state_s > 0.0)
    bone = {.step = static_cast<rt::Nanoseconds>(1e9 * params.bone_state_s),
            .own_thread = !params.virtual_time,
            .history = params.procedure ? HistoryOf(*params.procedure, setup.X_WG) : BoneHistory()};
  RecordedTopics topics(
      setup, params.procedure ? std::span(params.procedure->tools()) : std::span<const ProcedureTool>(),
      bone);
  auto recorder = io::Recorder::Open(
      {.path = params.recording,
       .writer_thread = !params.virtual_time,
       .live = params.virtual_time ? static_cast<io::RecordSink*>(&deflections) : &faults_seen,
       .topics = &topics},
      {.stamp = params.virtual_time ? 0 : rt::MonotonicNow(),
       .version = OSTEON_VERSION,
       .engine = engine.name(),
       .device = engine.device(),
       .scene = setup.bone.name,
       .tool = setup.config.tool.tool.name,
       .force_limit_N = control::ForceLimit_N(setup.config.servo),
       .limits = LimitLines(setup.config.servo),
       .config_text = setup.config_text,
       .config = setup.config_source,
       .utc = params.virtual_time ? 0 : UtcNow(),
       .build = BuildName(),
       .machine = MachineName(),
       .packing = setup.planned ? std::optional(MakePackingRecord(setup)) : std::nullopt});
  if (!recorder) return tl::make_unexpected(CellRunError{.what = recorder.error()});
  deflections.RecordIn(**recorder);
  faults_seen.RecordIn(**recorder);
  connections.faults = &faults;

  // a refused run leaves no empty recording
  const auto refuse = [&](CellRunError error) {
    recorder->reset();
    std::error_code ignored;
    if (!error.begun && std::filesystem::is_regular_file(params.recording, ignored))
      std::filesystem::remove(params.recording, ignored);
    return tl::make_unexpected(std::move(error));
  };
  if (params.cell && !params.virtual_time) {
    auto cell = CellProcess::Start(*params.cell);
    if (!cell) return refuse({.what = cell.error()});
    connections.cell = std::move(*cell);
  }
  if (setup.planned)
    (*recorder)->PushEvent(params.virtual_time ? 0 : rt::MonotonicNow(),
                           kPackingEvent + PlannedText(*setup.planned));
  if (params.begins) params.begins();
  auto run = params.virtual_time ? RunVirtual(setup, runner, **recorder, params)
                                 : RunWall(setup, runner, connections, **recorder, params);
  if (!run) return refuse(run.error());
  CellRunResult& result = *run;
  if (!params.virtual_time) {  // in virtual time, no packing is being made now
    runner.EndAdaptiveResolution();
    runner.RecordEvents(**recorder, rt::MonotonicNow());
  }
  if (params.procedure) result.session_error = params.procedure->End(runner.engine());
  result.rezoned = runner.TakeRezoned();
  const auto counts = (*recorder)->Close();
  result.recording = counts ? *counts : (*recorder)->counts();
  if (!counts) result.recording_error = counts.error();
  if (params.remote) result.engine_process = params.remote->Finish(params.recording);
  result.after = runner.engine().Snapshot();
  result.events = runner.events();
  result.min_wall_m = watch.min_wall_m();
  if (params.procedure)
    if (const auto wall_m = params.procedure->min_wall_m();
        wall_m && result.min_wall_m.value_or(*wall_m) >= *wall_m)
      result.min_wall_m = wall_m;
  return run;
}

}  // namespace osteon::session
