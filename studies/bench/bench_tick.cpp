#include "studies/bench/bench_tick.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/latest_value.h"
#include "base/no_alloc_scope.h"
#include "base/realtime_thread.h"
#include "base/write_text.h"
#include "config/reading/load.h"
#include "config/reading/strict/reader.h"
#include "control/loop/loop_repeat.h"
#include "hil/can/memory_can_bus.h"
#include "hil/device_wires.h"
#include "hil/udp_client.h"
#include "io/devices/device_clients.h"
#include "io/fri/fri_link.h"
#include "io/recording/recorder.h"
#include "session/process/exit_code.h"
#include "session/run/simulated_setup.h"
#include "session/setup/recorded_config.h"
#include "session/summary/chart_files.h"
#include "simulation/fidelity/frame_workload.h"
#include "studies/bench/loopback_baseline.h"
#include "studies/bench/tick_parts.h"

namespace osteon::app {
namespace {

using control::ReceiveResult;

constexpr const char* kLoopback = "127.0.0.1";
constexpr int kFrameTicks = 2;         // for a 500 Hz simulation
constexpr double kPlaneTilt_rad = .6;  // angle between the planes' normals and the feed axis
// Height of the planes above the place where the tool would meet the cup.
constexpr double kEarly_m = 0.01;
constexpr double kPresses_N = 1.0;         // coupling force from which a tick counts
constexpr std::size_t kBaselineEvery = 8;  // one period in this many ticks times the kernel alone
constexpr double kScriptShare = 4.0;       // length of the script over that of its timed part
constexpr std::array<const char*, 5> kStages{"receive", "devices", "loop", "send", "record"};

// The force sensor and the drive in memory, with both sides of each connection.
class Devices {
 public:
  Devices(const config::CellConfig& cell, std::unique_ptr<io::DeviceClients> clients)
      : clients_(std::move(clients)), devices_(cell.simulated_devices) {
    std::vector<io::CanBus*> ends;
    pumps_.reserve(cell.devices.buses.size());
    for (std::size_t i = 0; i < cell.devices.buses.size(); ++i) {
      hil::MemoryCanBus &ours = our_ends_.emplace_back(now_), &theirs = their_ends_.emplace_back(now_);
      hil::MemoryCanBus::Join(ours, theirs);
      ends.push_back(&theirs);
      clients_->AddToPump(pumps_.emplace_back(ours), i);
    }
    wires_.emplace(ends, devices_, cell.devices, hil::InjectionParams{}, &now_);
  }

  // Advances the simulated devices; not timed.
  void Simulate(const Wrench& F_S, rt::Nanoseconds now) {
    now_ = now;
    devices_.SetLoad(F_S);
    wires_->Pump(now);
  }
  // Advances our side of the connections, as WiredDevices::Exchange does, but without the PLC, which another
  // thread reads.
  control::CellReadings Exchange(const control::CellCommands& commands, rt::Nanoseconds now) {
    clients_->Command(commands, now);
    for (io::CanPump& pump : pumps_) pump.Pump(now);
    return clients_->Readings(no_plc_, now);
  }

 private:
  std::unique_ptr<io::DeviceClients> clients_;
  hil::SimulatedDevices devices_;
  rt::Nanoseconds now_{0};
  std::deque<hil::MemoryCanBus> our_ends_, their_ends_;
  std::vector<io::CanPump> pumps_;
  std::optional<hil::DeviceWires> wires_;
  io::PlcReading no_plc_;
};

// Returns eight planes that touch a ball in the tool's path, as a simulation frame reports them: the tool's
// head touches all of them where it coincides with the ball, and presses on all when it goes farther along
// the feed.
simulation::ContactModel EightPlanes(const Vector3& p_WBall, double radius_m, const Pose& X_WT,
                                     double stiffness_N_per_m) {
  simulation::ContactModel model;
  model.contact_count = simulation::kMaxContacts;
  for (int i = 0; i < simulation::kMaxContacts; ++i) {
    const double turn = 2.0 * std::numbers::pi * i / simulation::kMaxContacts;
    const Vector3 n_T(std::sin(kPlaneTilt_rad) * std::cos(turn), std::sin(kPlaneTilt_rad) * std::sin(turn),
                      -std::cos(kPlaneTilt_rad));  // -z: against the feed
    const Vector3 n_W = X_WT.linear() * n_T;
    simulation::Contact& contact = model.contacts[static_cast<std::size_t>(i)];
    contact.p_TP_m = Vector3(Vector3(0.0, 0.0, -radius_m) - radius_m * n_T);
    contact.p_W_m = Vector3(p_WBall - radius_m * n_W);
    contact.n_W = n_W;
    contact.stiffness_N_per_m = stiffness_N_per_m;
    contact.mu = 0.3;
    contact.advance_m_per_s = 0.5e-3;
    contact.weight = 1.0 / simulation::kMaxContacts;
  }
  return model;
}

// The measured times, in us.
struct Times {
  std::vector<double> tick;
  std::array<std::vector<double>, kStages.size()> stages;
  std::array<std::vector<double>, TickParts::kCount> parts;
  std::vector<double> bare;            // of the kernel alone
  int allocations{0};                  // in the ticks
  double force_N{0.0}, pressing{0.0};  // means: coupling force, planes that press
  bool realtime{false};
};

class TickBench {
 public:
  // @throws std::runtime_error if something can't be opened.
  TickBench(const config::CellConfig& cell, double seconds, const std::filesystem::path& recording)
      : cell_(cell),
        loop_(MakeServoLoop(cell)),
        second_(MakeServoLoop(cell)),
        repeat_(second_),
        parts_(cell.servo, cell.robot.lbr()->params, cell.X_WB, cell.tool.X_FT),
        arm_(MakeSimulatedCell(cell, seconds)) {
    auto clients = io::DeviceClients::Make(cell.devices);
    if (!clients) throw std::runtime_error(clients.error());
    devices_.emplace(cell, std::move(*clients));
    auto link = io::FriLink::Open({.bind_address = kLoopback, .port = 0, .session = *cell.link.fri()});
    if (!link) throw std::runtime_error(link.error());
    link_ = std::move(*link);
    wire_ = std::make_unique<hil::UdpClient>("simulated arm", "client", kLoopback, link_->port());
    io::SessionInfo session;
    session.stamp = rt::MonotonicNow();
    auto recorder = io::Recorder::Open({.path = recording}, session);
    if (!recorder) throw std::runtime_error(recorder.error());
    recorder_ = std::move(*recorder);

    const auto& script = std::get<hil::ReamingScriptParams>(cell.script);
    radius_m_ = script.head_radius_m;
    p_WBall_ = cell.X_WG * Vector3(0.0, 0.0, kEarly_m);
  }

  // Runs in the calling thread. @throws std::runtime_error if a tick fails or the tool does not press.
  Times Run(std::size_t ticks) {
    Times times;
    times.realtime = rt::SetUpRealtimeThread(
                         {.lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024})
                         .realtime;
    times.tick.reserve(ticks);
    for (auto& each : times.stages) each.reserve(ticks);
    for (auto& each : times.parts) each.reserve(ticks);
    times.bare.reserve(ticks / kBaselineEvery + 1);
    const auto period = static_cast<rt::Nanoseconds>(arm_.period_s() * 1e9 + 0.5);
    rt::Nanoseconds due = 0;
    for (std::int64_t tick = 1; times.tick.size() < ticks && !Interrupted(); ++tick) {
      if (arm_.state().script_done || loop_.phase() == control::Phase::kStopped) break;
      // once the tool presses, keep a run's pace, so that the caches are as cold as in a run
      if (!times.tick.empty()) {
        due = std::max(due + period, rt::MonotonicNow());
        rt::SleepUntil(due);
        if (times.tick.size() / kBaselineEvery > times.bare.size()) {  // also with cold caches
          times.bare.push_back(baseline_.Time(message_bytes_, answer_bytes_));
          due += period;
          rt::SleepUntil(due);
        }
      }
      RunTick(tick, tick * period, times);
    }
    const auto count = static_cast<double>(std::max<std::size_t>(1, times.tick.size()));
    times.force_N /= count;
    times.pressing /= count;
    return times;
  }

  [[nodiscard]] safety::FaultSet faults() const { return loop_.faults(); }

 private:
  // Runs a tick in virtual time, so that the loop's ages do not depend on this machine's load.
  void RunTick(std::int64_t tick, rt::Nanoseconds now, Times& times) {
    const auto message = arm_.Step(now);
    devices_->Simulate(arm_.state().F_S, now);
    const simulation::ToolCommand before = loop_.tool_command();
    if (tick % kFrameTicks == 0 && before.stamp > 0) {
      simulation::ContactModel model =
          EightPlanes(p_WBall_, radius_m_, Pose(before.X_WT), cell_.servo.coupling.max_stiffness_N_per_m);
      model.frame = static_cast<std::uint64_t>(tick);
      model.pose_stamp = before.stamp;
      models_.Store(model);
    }
    const kinematics::JointVector q = Eigen::Map<const kinematics::JointVector>(command_.q.data());

    // rehearse as RunServo does before a message is due
    control::WarmUpTick(loop_, repeat_, *link_, command_);
    if (!wire_->Send(message)) throw std::runtime_error("the loopback took no message");

    std::array<rt::Nanoseconds, kStages.size() + 1> at{};
    const rt::NoAllocScope scope;
    at[0] = rt::MonotonicNow();
    const ReceiveResult received = link_->Receive(state_, at[0] + rt::kSecond);
    at[1] = rt::MonotonicNow();
    const control::CellReadings readings = devices_->Exchange(loop_.cell_commands(), now);
    at[2] = rt::MonotonicNow();
    const simulation::ContactModel& model = models_.Load();
    const control::TickRecord record = loop_.Tick(state_, received, readings, model, now, command_);
    at[3] = rt::MonotonicNow();
    const bool answered = link_->Send(command_);
    at[4] = rt::MonotonicNow();
    commands_.Store(loop_.tool_command());
    const bool recorded = recorder_->Push(record);
    at[5] = rt::MonotonicNow();
    const int calls = scope.heap_calls() + scope.locks();
    repeat_.StoreTick(record, model);

    if (received != ReceiveResult::kOk || !answered) throw std::runtime_error("a message was not answered");
    message_bytes_ = message.size();
    wire_->ReceiveAll(answer_, [this](std::span<const std::uint8_t> answer) {
      answer_bytes_ = answer.size();
      arm_.Receive(answer);
    });
    const double force_N = Vector3(record.F_coupling_T_W.f).norm();
    const bool counts = record.phase == control::Phase::kHaptic && force_N > kPresses_N && recorded;
    if (!counts) return;
    times.allocations += calls;
    times.force_N += force_N;
    times.tick.push_back(1e-3 * static_cast<double>(at.back() - at.front()));
    for (std::size_t i = 0; i < kStages.size(); ++i)
      times.stages[i].push_back(1e-3 * static_cast<double>(at[i + 1] - at[i]));
    TimeParts(q, Pose(before.X_WT), Pose(record.X_WT_cmd), now, times);
  }

  void TimeParts(const kinematics::JointVector& q, const Pose& X_before, const Pose& X_after,
                 rt::Nanoseconds now, Times& times) {
    const double period_s = arm_.period_s();
    const Matrix3 R_turned = X_after.linear() * X_before.linear().transpose();
    const auto us = parts_.Time({.q = q,
                                 .X_WT = X_before,
                                 .V_WT = {.v = (X_after.translation() - X_before.translation()) / period_s,
                                          .w = LogRotation(R_turned) / period_s},
                                 .now = now},
                                models_.Load());
    for (std::size_t i = 0; i < us.size(); ++i) times.parts[i].push_back(us[i]);
    times.pressing += parts_.active_contacts();
  }

  config::CellConfig cell_;
  control::ServoLoop loop_, second_;
  control::LoopRepeat repeat_;
  TickParts parts_;
  hil::SimulatedCell arm_;
  std::optional<Devices> devices_;
  std::unique_ptr<io::FriLink> link_;
  std::unique_ptr<hil::UdpClient> wire_;
  std::unique_ptr<io::Recorder> recorder_;
  rt::LatestValue<simulation::ContactModel> models_;
  rt::LatestValue<simulation::ToolCommand> commands_;
  control::ArmState state_;
  control::ArmCommand command_;
  std::array<std::uint8_t, 2048> answer_{};
  LoopbackBaseline baseline_;
  std::size_t message_bytes_{0}, answer_bytes_{0};
  Vector3 p_WBall_;
  double radius_m_{0.0};
};

nlohmann::ordered_json Json(const simulation::TimeFigures& t) {
  return {{"p50", t.p50_us}, {"p95", t.p95_us}, {"p99", t.p99_us}, {"p999", t.p999_us}, {"max", t.max_us}};
}

std::string Row(std::string_view name, const simulation::TimeFigures& t) {
  return fmt::format("{:<14}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.1f}\n", name, t.p50_us, t.p95_us, t.p99_us,
                     t.p999_us, t.max_us);
}

// A file that is removed with the object.
class TemporaryFile {
 public:
  TemporaryFile() : path_((std::filesystem::temp_directory_path() / "osteon_tick_XXXXXX").string()) {
    const int file = mkstemp(path_.data());
    if (file < 0) throw std::runtime_error(path_ + ": cannot make a file");
    close(file);
  }
  ~TemporaryFile() { unlink(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The demo cell reduced to what this loop can use: no PLC (another thread's) and no injections.
config::CellConfig BenchCell(const std::filesystem::path& config_root) {
  config::CellConfig cell = config::LoadCell(config_root / "cells" / "demo.yaml");
  cell.devices.plc.reset();
  cell.simulated_plc.reset();
  cell.servo.has_interlock = false;
  return cell;
}

int Run(const BenchTickOptions& options) {
  const config::CellConfig cell = BenchCell(options.config_root);
  if (!std::holds_alternative<hil::ReamingScriptParams>(cell.script) || !cell.servo.arm_body)
    return Fail("bench tick", "cells/demo.yaml: accepted a reaming script and an arm with masses");
  const TemporaryFile recording;
  const double seconds =
      std::max(5.0, kScriptShare * cell.servo.period_s * static_cast<double>(options.ticks));
  TickBench bench(cell, seconds, recording.path());
  InstallInterrupt();
  Times times;
  std::string wrong;
  std::thread([&] {  // a separate thread, so that the process does not keep the priority
    try {
      times = bench.Run(options.ticks);
    } catch (const std::runtime_error& error) {
      wrong = error.what();
    }
  })
      .join();
  if (!wrong.empty()) return Fail("bench tick", wrong, kFailed);
  if (Interrupted()) return kExitInterrupted;
  if (times.tick.size() < options.ticks)
    return Fail("bench tick",
                fmt::format("the tool pressed in {} ticks of {}{}", times.tick.size(), options.ticks,
                            bench.faults().Any() ? ", then the loop stopped itself" : ""),
                kFailed);

  const std::string machine = MachineName();
  fmt::print("Osteon bench tick: {}, {} ticks at {:.0f} N, {}, on {}\n\n{:<14}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
             "cells/demo.yaml", options.ticks, times.force_N, times.realtime ? "SCHED_FIFO" : "no SCHED_FIFO",
             machine, "us", "p50", "p95", "p99", "p999", "max");
  nlohmann::ordered_json stages;
  const simulation::TimeFigures tick = simulation::FiguresOf(times.tick);
  fmt::print("{}", Row("tick", tick));
  for (std::size_t i = 0; i < kStages.size(); ++i) {
    const auto figures = simulation::FiguresOf(times.stages[i]);
    fmt::print("{}", Row(fmt::format("  {}", kStages[i]), figures));
    stages[kStages[i]] = Json(figures);
  }
  const simulation::TimeFigures bare = simulation::FiguresOf(times.bare);
  fmt::print("{}", Row("kernel alone", bare));
  fmt::print("of the loop, on the same inputs\n");
  for (std::size_t i = 0; i < TickParts::kCount; ++i) {
    const auto figures = simulation::FiguresOf(times.parts[i]);
    fmt::print("{}", Row(fmt::format("    {}", TickParts::kNames[i]), figures));
    stages[std::string(TickParts::kNames[i])] = Json(figures);
  }
  const bool counted = rt::NoAllocScope::Counts();
  fmt::print("heap calls and locks: {}\n", counted ? std::to_string(times.allocations) : "not counted here");

  const nlohmann::ordered_json json{
      {"schema", "osteon.bench.tick/1"},
      {"subcommand", "bench tick"},
      {"cell", "cells/demo.yaml"},
      {"ticks", options.ticks},
      {"contacts", simulation::kMaxContacts},
      {"contacts_pressing_mean", times.pressing},
      {"mean_force_N", times.force_N},
      {"tick_us", Json(tick)},
      {"stage_us", stages},
      {"kernel_alone_us", Json(bare)},
      {"allocations", counted ? nlohmann::ordered_json(times.allocations) : nlohmann::ordered_json(nullptr)},
      {"realtime_priority", times.realtime},
      {"machine", machine}};
  if (options.json.empty()) return 0;
  const auto written = WriteText(options.json, JsonText(json));
  return written ? 0 : Fail("bench tick", written.error(), kFailed);
}

}  // namespace

int RunBenchTick(const BenchTickOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return Fail("bench tick", error.what());
  } catch (const std::exception& error) {
    return Fail("bench tick", error.what(), kFailed);
  }
}

}  // namespace osteon::app
