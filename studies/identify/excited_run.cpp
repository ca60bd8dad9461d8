#include "studies/identify/excited_run.h"

#include <cmath>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/clock.h"
#include "control/loop/run_servo.h"
#include "hil/cell_host.h"
#include "hil/impaired_cell.h"
#include "hil/operator/hand_script.h"
#include "io/devices/wired_devices.h"
#include "io/recording/recorder.h"
#include "safety/watchdog.h"
#include "session/run/arm_connection.h"
#include "session/run/cell_ports.h"
#include "session/run/simulated_setup.h"
#include "session/run/start_path.h"
#include "session/run/virtual_devices.h"
#include "session/setup/build_name.h"
#include "session/setup/recorded_config.h"
#include "session/stops/stop_records.h"
#include "session/summary/chart_files.h"
#include "session/summary/each_fault.h"
#include "session/summary/limit_rows.h"

namespace osteon::studies {
namespace {

constexpr double kGiveUp_s = 60.0;   // longest virtual time to wait for the excitation
constexpr double kFrame_s = 0.02;    // time between two models of free air
constexpr double kRenders_s = 0.1;   // time for which the loop renders before the pause is requested
constexpr double kAfter_s = 0.5;     // time that is recorded after the excitation
constexpr double kFarAway_m = 10.0;  // height of a hand that never reaches the handle
// Time for which a holding hand holds, and its largest force.
constexpr double kStands_s = 36000.0, kHeldBound_N = 100.0;

// Whether the run is in virtual time.
bool IsVirtual(const ExcitedRunParams& params) { return params.simulated && !params.wall_time; }

// The cell of an excited run: the spindle does not turn, and no guidance acts.
config::CellConfig Quiet(const config::CellConfig& cell) {
  config::CellConfig quiet = cell;
  quiet.servo.spindle_rad_per_s = 0.0;
  quiet.servo.guidance.reset();
  return quiet;
}

// Makes the arm with its hand. The hand holds the handle at the start with its full grip, or it stays at a
// place that the tool never reaches.
hil::SimulatedCell MakeArm(const config::CellConfig& cell, bool held) {
  hil::SimulatedCellParams params = cell.simulated;
  params.hand.incidents = {};
  // so that the simulated sensor feels the tool's inertia, as a real sensor does
  if (!params.kr) params.sensor_feels_inertia = true;
  return std::visit(
      [&](const auto& script) {
        Pose X_WC = script.X_WC;
        if (!held) X_WC.translation().z() += kFarAway_m;
        const hil::HandKey stands{.height_m = script.start_height_m, .force_limit_N = kHeldBound_N};
        return hil::SimulatedCell(params, hil::HandScript(X_WC, script.head_radius_m, script.tool_yaw_rad,
                                                          1.0, stands, {{"hold", kStands_s, stands}}));
      },
      cell.script);
}

// A contact model of free air: nothing touches the tool.
simulation::ContactModel FreeAir(const Pose& X_WT, rt::Nanoseconds now, std::uint64_t frame) {
  simulation::ContactModel model;
  model.X_WP = X_WT;
  model.pose_stamp = now;
  model.frame = frame;
  return model;
}

// Makes the recording's folder and opens the recording. In virtual time the caller writes it by Drain().
tl::expected<std::unique_ptr<io::Recorder>, std::string> OpenRecorder(const session::CellSetup& setup,
                                                                      const ExcitedRunParams& params) {
  const auto folder = params.recording.parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) return tl::unexpected(folder.string() + ": cannot make the folder: " + error.message());
  const bool is_virtual = IsVirtual(params);
  return io::Recorder::Open({.path = params.recording, .writer_thread = !is_virtual},
                            {.stamp = is_virtual ? 0 : rt::MonotonicNow(),
                             .version = OSTEON_VERSION,
                             .engine = "free air",
                             .device = "none",
                             .scene = setup.bone.name,
                             .tool = setup.config.tool.tool.name,
                             .force_limit_N = control::ForceLimit_N(setup.config.servo),
                             .limits = session::LimitLines(setup.config.servo),
                             .config_text = setup.config_text,
                             .config = setup.config_source,
                             .build = session::BuildName(),
                             .machine = session::MachineName()});
}

// The names of the faults, with commas.
std::string FaultText(safety::FaultSet faults) {
  std::string text;
  session::ForEachFault(faults, [&](safety::Fault, const safety::FaultText& fault) {
    text += (text.empty() ? "" : ", ") + std::string(fault.name);
  });
  return text;
}

// Says why a run ended early, for the user. @param begun  the excitation had begun
std::string WhyEnded(const control::ServoLoop& loop, const control::ExcitedHoldStep& step, bool begun) {
  if (loop.faults().Any()) return "the cell stopped: " + FaultText(loop.faults());
  if (step.abort != control::ExcitationAbort::kNone) return Describe(step.abort);
  return begun ? "it was stopped before its end" : "the arm was not handed over, or motion was not permitted";
}

// Requests the pause after the loop has rendered for kRenders_s.
class PauseRequest {
 public:
  explicit PauseRequest(double period_s) : ticks_(std::lround(kRenders_s / period_s)) {}
  void Tick(control::ServoLoop& loop) {
    if (safety::Renders(loop.state()) && ++rendered_ == ticks_) loop.RequestPause();
  }

 private:
  long ticks_, rendered_{0};
};

// One excited run in virtual time: arm, loop and simulation take turns in one thread, as in RunCell.
class VirtualRun {
 public:
  VirtualRun(const config::CellConfig& cell, const ExcitedAxis& axis, io::Recorder& recorder,
             std::unique_ptr<session::VirtualDevices> devices, bool held)
      : loop_(session::MakeServoLoop(cell)),
        axis_(axis),
        hold_(axis.hold),
        recorder_(recorder),
        devices_(std::move(devices)),
        arm_(MakeArm(cell, held), cell.injections),
        session_(cell.link),
        pause_(cell.servo.period_s),
        period_(static_cast<rt::Nanoseconds>(arm_.period_s() * 1e9)),
        period_s_(arm_.period_s()) {}

  // @returns why the run ended early; empty: it was complete
  std::string Run(const std::atomic<bool>* stop) {
    const double rest_s = hold_.params().wait_s,
                 limit_s = kGiveUp_s + rest_s + 2.0 * hold_.path().duration_s();
    long after = std::lround(kAfter_s / period_s_);
    for (long tick = 1; after > 0; ++tick) {
      const bool ended = hold_.done() || loop_.phase() == control::Phase::kStopped;
      const bool late =
          static_cast<double>(tick) * period_s_ > limit_s ||
          (!step_.excites && !hold_.done() && static_cast<double>(tick) * period_s_ > kGiveUp_s + rest_s);
      if (ended || late || (stop && stop->load())) {
        loop_.RequestStop();
        --after;
      }
      Tick(tick);
      if (tick % 100 == 0) recorder_.Drain();
    }
    if (step_.path.part == control::ExcitationPart::kDone && !loop_.faults().Any()) return "";
    return WhyEnded(loop_, step_, begun_);
  }

 private:
  // Runs one period: arm, devices, loop, excitation, and last the answer to the arm.
  void Tick(long tick) {
    const rt::Nanoseconds now = tick * period_;
    arm_.cell().SetPower(devices_->power());
    bool accepted = false;
    arm_.Step(now, [&](std::span<const std::uint8_t> message, rt::Nanoseconds arrival) {
      accepted |= session_.Accept(message, arrival, state_);
    });
    if (arm_.state().active_once) devices_->StartSchedule(now);
    devices_->SetLoad(arm_.cell().force().F_S);
    UpdateModel(tick, now);
    const control::CellReadings readings = devices_->Exchange(loop_.cell_commands(), now);
    const auto received = accepted ? control::ReceiveResult::kOk : control::ReceiveResult::kTimeout;
    const control::TickRecord record = loop_.Tick(
        {.state = state_, .received = received, .readings = readings, .model = model_, .now = now}, command_);
    step_ = hold_.Step(ExcitedTickOf(record));
    begun_ |= step_.excites;
    pause_.Tick(loop_);
    recorder_.Push(record);
    control::ArmCommand sent = command_;
    AddExcitation(axis_, step_, state_.command_mode, sent);
    if (const auto answer = session_.Answer(sent); accepted && !answer.empty()) arm_.Receive(answer);
  }

  // Gives the loop a new model of free air every kFrame_s.
  void UpdateModel(long tick, rt::Nanoseconds now) {
    const auto frame = std::lround(kFrame_s / period_s_);
    if (tick % frame != 0 || loop_.tool_command().stamp == 0) return;
    model_ = FreeAir(loop_.tool_command().X_WT, now, ++frames_);
    simulation::FrameRecord frame_record;
    frame_record.stamp = now;
    frame_record.model = model_;
    recorder_.PushFrame(frame_record);
  }

  control::ServoLoop loop_;
  const ExcitedAxis& axis_;
  control::ExcitedHold hold_;
  io::Recorder& recorder_;
  std::unique_ptr<session::VirtualDevices> devices_;
  hil::ImpairedCell arm_;
  session::ArmProtocolSession session_;
  PauseRequest pause_;
  rt::Nanoseconds period_;
  double period_s_;
  control::ArmState state_;
  control::ArmCommand command_;
  control::ExcitedHoldStep step_;
  simulation::ContactModel model_;
  std::uint64_t frames_{0};
  bool begun_{false};
};

// Runs the simulated cell in virtual time.
tl::expected<void, std::string> RunVirtual(const session::CellSetup& setup, const ExcitedAxis& axis,
                                           io::Recorder& recorder, const ExcitedRunParams& params) {
  const config::CellConfig cell = Quiet(setup.config);
  const kinematics::JointVector q_first =
      Eigen::Map<const kinematics::JointVector>(cell.simulated.q_start.data());
  if (std::string why = session::ValidateStartPath(setup, q_first); !why.empty())
    return tl::unexpected(std::move(why));
  auto devices = session::VirtualDevices::Make(cell);
  if (!devices) return tl::unexpected(devices.error());
  VirtualRun run(cell, axis, recorder, std::move(*devices), params.request.held);
  if (std::string why = run.Run(params.stop); !why.empty()) return tl::unexpected(std::move(why));
  return {};
}

// The connections of a connected cell. The excitation acts between loop and arm: it adds its offset or force
// to each command. It is computed from the values that the tick's record has, so that the recording
// reproduces it.
class ExcitedWires final : public control::ArmLink, public control::CellDevices {
 public:
  ExcitedWires(control::ArmLink& link, control::CellDevices& devices, control::ServoLoop& loop,
               const ExcitedAxis& axis)
      : link_(link),
        devices_(devices),
        loop_(loop),
        axis_(axis),
        hold_(axis.hold),
        pause_(axis.hold.period_s) {}

  control::ReceiveResult Receive(control::ArmState& state, rt::Nanoseconds deadline) OSTEON_RT override {
    const control::ReceiveResult received = link_.Receive(state, deadline);
    state_ = state;
    return received;
  }
  bool Await(rt::Nanoseconds time) OSTEON_RT override { return link_.Await(time); }
  void WarmUp(const control::ArmCommand& command) OSTEON_RT override { link_.WarmUp(command); }
  control::CellReadings Exchange(const control::CellCommands& commands,
                                 rt::Nanoseconds now) OSTEON_RT override {
    readings_ = devices_.Exchange(commands, now);
    now_ = now;
    return readings_;
  }
  bool Send(const control::ArmCommand& command) OSTEON_RT override {
    step_ = hold_.Step({.received = true,
                        .sequence = state_.sequence,
                        .activation = state_.activation,
                        .active = state_.session == control::SessionState::kCommandingActive,
                        .lost = state_.lost,
                        .answers_lost = state_.answers_lost,
                        .q_meas = state_.q_meas,
                        .q_hold = command.q,
                        .force_S_N = readings_.force.F_S.f,
                        .sensor_age_s = safety::StampAge(now_, readings_.force.stamp),
                        .sensor_trusted = readings_.force.trusted,
                        .permitted = readings_.interlock.permitted && readings_.interlock.enabled,
                        .state = loop_.state()});
    if (step_.excites) begun_.store(true, std::memory_order_relaxed);
    if (hold_.done()) done_.store(true, std::memory_order_relaxed);
    pause_.Tick(loop_);
    control::ArmCommand sent = command;
    AddExcitation(axis_, step_, state_.command_mode, sent);
    return link_.Send(sent);
  }

  [[nodiscard]] bool done() const { return done_.load(); }
  [[nodiscard]] bool begun() const { return begun_.load(); }
  [[nodiscard]] const control::ExcitedHoldStep& step() const {
    return step_;
  }  // after the servo thread's end

 private:
  control::ArmLink& link_;
  control::CellDevices& devices_;
  control::ServoLoop& loop_;
  const ExcitedAxis& axis_;
  control::ExcitedHold hold_;
  PauseRequest pause_;
  control::ArmState state_;
  control::CellReadings readings_;
  rt::Nanoseconds now_{0};
  control::ExcitedHoldStep step_;
  std::atomic<bool> done_{false}, begun_{false};
};

// Stands in for the simulation: answers the loop with a model of free air at the loop's own command.
class FreeAirPort final : public control::SimulationPort {
 public:
  const simulation::ContactModel& Load() OSTEON_RT override { return model_; }
  void Store(const simulation::ToolCommand& command) OSTEON_RT override {
    if (command.stamp == 0) return;
    model_.X_WP = command.X_WT;
    model_.pose_stamp = command.stamp;
    ++model_.frame;
  }

 private:
  simulation::ContactModel model_;
};

// Runs a cell whose arm and devices are reached by their protocols; the servo loop runs in a thread of its
// own.
tl::expected<void, std::string> RunConnected(const session::CellSetup& setup, const ExcitedAxis& axis,
                                             io::Recorder& recorder, const ExcitedRunParams& params) {
  const config::CellConfig cell = Quiet(setup.config);
  auto arm = session::ArmConnection::Open(cell.link, cell.guard ? "" : cell.link.arm_host);
  if (!arm) return tl::unexpected(arm.error());
  auto devices = io::WiredDevices::Open(cell.devices);
  if (!devices) return tl::unexpected(devices.error());
  control::ServoLoop loop = session::MakeServoLoop(cell);
  loop.AllowStart(false);
  ExcitedWires wires(arm->link(), **devices, loop, axis);
  FreeAirPort free_air;
  rt::LatestValue<control::StandingArm> standing;
  std::atomic<bool> ended{false}, stop{false};
  control::RunServoResult servo;
  std::thread thread([&] {
    rt::NameThread("servo");
    servo = control::RunServo(loop,
                              {.link = wires, .devices = wires, .simulation = free_air, .recorder = recorder},
                              {.deadline_s = 5.0 * cell.servo.period_s,
                               .seconds = 0.0,
                               .give_up_s = params.wait_s,
                               .at_rest_s = kAfter_s,
                               .standing = &standing,
                               .stop = &stop});
    arm->EndSession();
    ended.store(true);
  });
  std::string path_blocked;
  bool checked = false;
  while (!ended.load()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (const control::StandingArm& at = standing.Load(); at.known && !checked && path_blocked.empty()) {
      path_blocked =
          session::ValidateStartPath(setup, Eigen::Map<const kinematics::JointVector>(at.q.data()));
      checked = true;
      loop.AllowStart(path_blocked.empty());
    }
    if (wires.done() || !path_blocked.empty() || (params.stop && params.stop->load())) stop.store(true);
  }
  thread.join();
  if (!path_blocked.empty()) return tl::unexpected(path_blocked);
  if (wires.step().path.part == control::ExcitationPart::kDone && !servo.faults.Any()) return {};
  std::string why = WhyEnded(loop, wires.step(), wires.begun());
  const std::string link = arm->Diagnosis();
  return tl::unexpected(link.empty() ? why : why + "; " + link);
}

// Runs in wall time, with a simulated cell in this process at the other end of the connections.
tl::expected<void, std::string> RunOnLoopback(const session::CellSetup& setup, const ExcitedAxis& axis,
                                              io::Recorder& recorder, const ExcitedRunParams& params) {
  if (setup.config.guard)
    return tl::unexpected(std::string(
        "found a cell with a guard, accepted one without, or virtual time: its guard is a process"));
  session::CellSetup wired = setup;
  if (const auto port = session::UseSimulated(wired.config, 0); !port) return tl::unexpected(port.error());
  hil::CellHost host(session::HostParams(wired.config), MakeArm(wired.config, params.request.held));
  auto run = RunConnected(wired, axis, recorder, params);
  host.Stop();
  return run;
}

// Names an obstacle within the joint's travel; empty: there is none.
std::string BlockedWay(const session::CellSetup& setup, int joint) {
  kinematics::JointVector travel = kinematics::JointVector::Zero();
  travel[joint - 1] = kMaxJointTravel_rad;
  const kinematics::JointVector& q = setup.config.start.q;
  const std::string blocked = session::ValidatePath(setup, q - travel, q + travel);
  return blocked.empty() ? blocked : fmt::format("the way of joint A{}: {}", joint, blocked);
}

}  // namespace

tl::expected<void, std::string> RunExcited(const session::CellSetup& setup, const ExcitedRunParams& params) {
  const auto axis = ExcitedAxisOf(setup.config, params.request);
  if (!axis) return tl::unexpected(axis.error());
  if (params.request.joint > 0)
    if (std::string blocked = BlockedWay(setup, params.request.joint); !blocked.empty())
      return tl::unexpected(std::move(blocked));
  auto recorder = OpenRecorder(setup, params);
  if (!recorder) return tl::unexpected(recorder.error());
  (*recorder)->PushEvent(IsVirtual(params) ? 0 : rt::MonotonicNow(), EventText(params.request));
  const auto run = !params.simulated  ? RunConnected(setup, *axis, **recorder, params)
                   : params.wall_time ? RunOnLoopback(setup, *axis, **recorder, params)
                                      : RunVirtual(setup, *axis, **recorder, params);
  const auto counts = (*recorder)->Close();
  if (!run) return tl::unexpected(run.error());
  if (!counts) return tl::unexpected(counts.error());
  if (counts->dropped_ticks > 0)
    return tl::unexpected(
        fmt::format("{}: found {} ticks that were not recorded, accepted none: the disk is too slow",
                    params.recording.string(), counts->dropped_ticks));
  return {};
}

}  // namespace osteon::studies
