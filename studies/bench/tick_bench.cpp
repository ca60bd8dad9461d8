#include "studies/bench/tick_bench.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <variant>

#include "base/interrupt.h"
#include "base/latest_value.h"
#include "base/no_alloc_scope.h"
#include "base/realtime_thread.h"
#include "config/reading/load.h"
#include "control/loop/loop_repeat.h"
#include "hil/can/memory_can_bus.h"
#include "hil/device_wires.h"
#include "hil/udp_client.h"
#include "io/devices/device_clients.h"
#include "io/fri/fri_link.h"
#include "io/recording/recorder.h"
#include "session/run/simulated_setup.h"
#include "session/setup/recorded_config.h"
#include "studies/bench/loopback_baseline.h"

namespace osteon::studies {
namespace {

using control::ReceiveResult;

constexpr const char* kLoopback = "127.0.0.1";
constexpr int kFrameTicks = 2;         // ticks per frame, for a simulation at 500 Hz
constexpr double kPlaneTilt_rad = .6;  // angle between the planes' normals and the feed axis
// Height of the planes above the place where the tool would meet the cup.
constexpr double kEarly_m = 0.01;
constexpr double kPresses_N = 1.0;         // coupling force from which a tick counts
constexpr std::size_t kBaselineEvery = 8;  // the kernel alone is timed once in this many ticks
constexpr double kScriptShare = 4.0;       // length of the script, divided by the duration of the timed ticks

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
  // Advances the loop's side of the connections, as WiredDevices::Exchange does. The PLC is left out, because
  // in a real cell another thread reads it.
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
// head touches all planes when it coincides with the ball, and presses on all planes when it moves farther
// along the feed.
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

}  // namespace

struct TickBench::Parts {
  Parts(const config::CellConfig& cell, double seconds,
        const std::optional<control::GuidanceParams>& guidance)
      : cell_(cell),
        loop_(session::MakeServoLoop(cell)),
        second_(session::MakeServoLoop(cell)),
        repeat_(second_),
        parts_(cell.servo, cell.robot.lbr()->params, cell.X_WB, cell.tool.X_FT),
        arm_(session::MakeSimulatedCell(cell, seconds)) {
    if (guidance)
      for (control::ServoLoop* loop : {&loop_, &second_})
        loop->SetTools({{.X_FT = cell.tool.X_FT,
                         .sensor = cell.servo.sensor,
                         .guidance = guidance,
                         .bending = cell.servo.compliance.tool}},
                       0);
    auto clients = io::DeviceClients::Make(cell.devices);
    if (!clients) throw std::runtime_error(clients.error());
    devices_.emplace(cell, std::move(*clients));
    auto link = io::FriLink::Open({.bind_address = kLoopback, .port = 0, .session = *cell.link.fri()});
    if (!link) throw std::runtime_error(link.error());
    link_ = std::move(*link);
    wire_ = std::make_unique<hil::UdpClient>("simulated arm", "client", kLoopback, link_->port());
    io::SessionInfo session;
    session.stamp = rt::MonotonicNow();
    auto recorder = io::Recorder::Open({.path = recording_.path()}, session);
    if (!recorder) throw std::runtime_error(recorder.error());
    recorder_ = std::move(*recorder);

    const auto& script = std::get<hil::ReamingScriptParams>(cell.script);
    radius_m_ = script.head_radius_m;
    p_WBall_ = cell.X_WG * Vector3(0.0, 0.0, kEarly_m);
  }

  [[nodiscard]] bool ended() const {
    return arm_.state().script_done || loop_.phase() == control::Phase::kStopped;
  }
  [[nodiscard]] rt::Nanoseconds period() const {
    return static_cast<rt::Nanoseconds>(arm_.period_s() * 1e9 + 0.5);
  }
  // Runs the next tick of virtual time.
  void RunNext(TickTimes& times) {
    ++tick_;
    RunTick(tick_, tick_ * period(), times);
  }
  // Times the kernel alone, with datagrams as long as those of the last tick.
  void TimeKernel(TickTimes& times) { times.bare.push_back(baseline_.Time(message_bytes_, answer_bytes_)); }

  // Runs a tick in virtual time, so that the loop's ages do not depend on this machine's load.
  void RunTick(std::int64_t tick, rt::Nanoseconds now, TickTimes& times) {
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

    // warm the caches, as RunServo does before a message is due
    control::WarmUpTick(loop_, repeat_, *link_, command_);
    if (!wire_->Send(message)) throw std::runtime_error("the loopback took no message");

    std::array<rt::Nanoseconds, TickTimes::kStages.size() + 1> at{};
    const rt::NoAllocScope scope;
    at[0] = rt::MonotonicNow();
    const ReceiveResult received = link_->Receive(state_, at[0] + rt::kSecond);
    at[1] = rt::MonotonicNow();
    const control::CellReadings readings = devices_->Exchange(loop_.cell_commands(), now);
    at[2] = rt::MonotonicNow();
    const simulation::ContactModel& model = models_.Load();
    const control::TickRecord record = loop_.Tick(
        {.state = state_, .received = received, .readings = readings, .model = model, .now = now}, command_);
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
    times.guided += record.guidance.share > 0.0 && record.guidance.potential_J > 0.0 ? 1.0 : 0.0;
    times.tick.push_back(1e-3 * static_cast<double>(at.back() - at.front()));
    for (std::size_t i = 0; i < TickTimes::kStages.size(); ++i)
      times.stages[i].push_back(1e-3 * static_cast<double>(at[i + 1] - at[i]));
    TimeParts(q, Pose(before.X_WT), Pose(record.X_WT_cmd), now, times);
  }

  // Times the loop's parts once more on a tick's inputs: joint positions q, and the tool's pose before and
  // after.
  void TimeParts(const kinematics::JointVector& q, const Pose& X_before, const Pose& X_after,
                 rt::Nanoseconds now, TickTimes& times) {
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

  TemporaryFile recording_;
  config::CellConfig cell_;
  control::ServoLoop loop_;    // timed
  control::ServoLoop second_;  // repeats each tick, which warms the caches as in a run
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
  std::int64_t tick_{0};
};

TickBench::TickBench(const config::CellConfig& cell, double seconds,
                     const std::optional<control::GuidanceParams>& guidance)
    : parts_(std::make_unique<Parts>(cell, seconds, guidance)) {}
TickBench::~TickBench() = default;
TickBench::TickBench(TickBench&&) noexcept = default;

safety::FaultSet TickBench::faults() const { return parts_->loop_.faults(); }

namespace {

// Does the work of TimeInTurn in the calling thread.
std::vector<TickTimes> TimeHere(std::span<TickBench> benches, std::size_t ticks) {
  std::vector<TickTimes> all(benches.size());
  const bool realtime =
      rt::SetUpRealtimeThread(
          {.lock_memory = true, .keep_cpus_awake = true, .prefault_stack_bytes = 256 * 1024})
          .realtime;
  for (TickTimes& times : all) {
    times.realtime = realtime;
    times.tick.reserve(ticks);
    for (auto& each : times.stages) each.reserve(ticks);
    for (auto& each : times.parts) each.reserve(ticks);
    times.bare.reserve(ticks / kBaselineEvery + 1);
  }
  // Until the tools press, run the ticks as fast as possible.
  for (std::size_t i = 0; i < benches.size(); ++i)
    while (all[i].tick.empty() && !benches[i].parts().ended() && !base::Interrupted())
      benches[i].parts().RunNext(all[i]);
  // once the tools press, keep a run's pace, so that the caches are as cold as in a run
  rt::Nanoseconds due = 0;
  const auto wait = [&](const TickBench::Parts& bench) {
    due = std::max(due + bench.period(), rt::MonotonicNow());
    rt::SleepUntil(due);
  };
  const auto is_over = [&](std::size_t i) {
    return all[i].tick.size() >= ticks || benches[i].parts().ended();
  };
  for (std::size_t round = 0; !base::Interrupted(); ++round) {
    bool over = true;
    for (std::size_t j = 0; j < benches.size(); ++j) {
      const std::size_t i = round % 2 == 0 ? j : benches.size() - 1 - j;
      if (is_over(i)) continue;
      over = false;
      TickBench::Parts& bench = benches[i].parts();
      wait(bench);
      if (all[i].tick.size() / kBaselineEvery >
          all[i].bare.size()) {  // in a period of its own, with cold caches, as a tick
        bench.TimeKernel(all[i]);
        wait(bench);
      }
      bench.RunNext(all[i]);
    }
    if (over) break;
  }
  for (TickTimes& times : all) {
    const auto count = static_cast<double>(std::max<std::size_t>(1, times.tick.size()));
    times.force_N /= count;
    times.pressing /= count;
    times.guided /= count;
  }
  return all;
}

}  // namespace

std::vector<TickTimes> TimeInTurn(std::span<TickBench> benches, std::size_t ticks) {
  std::vector<TickTimes> times;
  std::exception_ptr failure;
  std::thread([&] {
    try {
      times = TimeHere(benches, ticks);
    } catch (...) {
      failure = std::current_exception();
    }
  }).join();
  if (failure) std::rethrow_exception(failure);
  return times;
}

config::CellConfig BenchCell(const std::filesystem::path& config_root) {
  config::CellConfig cell = config::LoadCell(config_root / "cells" / "demo.yaml");
  cell.devices.plc.reset();
  cell.simulated_plc.reset();
  cell.servo.has_interlock = false;
  if (!std::holds_alternative<hil::ReamingScriptParams>(cell.script) || !cell.servo.arm_body)
    throw std::invalid_argument("cells/demo.yaml: accepted a reaming script and an arm with masses");
  return cell;
}

double ScriptSeconds(const config::CellConfig& cell, std::size_t ticks) {
  return std::max(5.0, kScriptShare * cell.servo.period_s * static_cast<double>(ticks));
}

}  // namespace osteon::studies
