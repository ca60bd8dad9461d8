#include "session/guard/guard.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/interrupt.h"
#include "base/json_text.h"
#include "base/write_text.h"
#include "config/reading/config_file_tracker.h"
#include "io/modbus/plc_client.h"
#include "session/process/exit_code.h"
#include "session/process/output.h"
#include "session/run/arm_connection.h"
#include "session/run/cell_ports.h"
#include "session/setup/config_checksum.h"
#include "session/setup/recorded_config.h"

namespace osteon::session {
namespace {

// Time between two checks of PLC, silence and Ctrl-C.
constexpr rt::Nanoseconds kPollInterval = 5 * rt::kMillisecond;
// period of the heartbeat; a withdrawal of the motion request is sent after at most this time
constexpr int kBeatEvery_ms = 10;
// longest time that the guard waits for the arm to come to rest after it was asked to end
constexpr rt::Nanoseconds kEndWithin = 3 * rt::kSecond;
// number of heartbeats with the withdrawn motion request before the heartbeat stops
constexpr std::uint32_t kLastWrites = 2;
// Silence of the controller is accepted for at least this many periods of its answers, even if these periods
// are long.
constexpr double kMinSilenceAnswers = 10.0;

void Say(const std::string& text) {
  fmt::print("osteon guard: {}\n", text);
  std::fflush(stdout);
}

// Makes the JSON of a latency's distribution [us].
nlohmann::ordered_json DelayJson(const rt::DurationHistogram& delay) {
  const auto us = [](rt::Nanoseconds time) { return 1e-3 * static_cast<double>(time); };
  return {{"count", delay.count()},
          {"p50", us(delay.Quantile(0.5))},
          {"p99", us(delay.Quantile(0.99))},
          {"max", us(delay.max())}};
}

// Formats median, 99th percentile and maximum of a latency.
std::string DelayText(const rt::DurationHistogram& delay) {
  return fmt::format("{:.0f} / {:.0f} / {:.0f} µs", 1e-3 * static_cast<double>(delay.Quantile(0.5)),
                     1e-3 * static_cast<double>(delay.Quantile(0.99)),
                     1e-3 * static_cast<double>(delay.max()));
}

// Returns the PLC client's parameters with the guard's role and heartbeat period.
io::PlcClientParams OfGuard(io::PlcClientParams params) {
  params.role = io::PlcRole::kGuard;
  params.heartbeat_every_ms = kBeatEvery_ms;
  return params;
}

// Writes the guard's heartbeat to the PLC. After the motion request was withdrawn and this was latched,
// kLastWrites more heartbeats follow.
class PlcBeat {
 public:
  explicit PlcBeat(const io::PlcClientParams& params) : client_(OfGuard(params)) {}

  /// Sets or withdraws the motion request, and continues the heartbeat unless it has to stop. @param ending
  /// the guard was asked to end
  void Step(const safety::GuardMonitor& monitor, bool ending) {
    const std::uint32_t writes = client_.Latest().counters.writes;
    client_.RequestMotion(monitor.permits() && !ending);
    if (!monitor.latched()) writes_before_ = writes;
    if (!monitor.latched() || writes - writes_before_ < kLastWrites) client_.NotifyAlive();
  }
  /// Stops the heartbeat. @returns the last reading of the PLC
  io::PlcReading End() {
    const io::PlcReading last = client_.Latest();
    client_.Stop();
    return last;
  }

 private:
  io::PlcClient client_;
  std::uint32_t writes_before_{0};  // number of heartbeats before the withdrawal was latched
};

// Prints the addresses of arm, controller and PLC, and the configuration's checksum.
void PrintAddresses(const config::CellConfig& cell, const GuardReport& report) {
  Say(fmt::format("{}: the arm sends to {}, the controller waits at {}", Describe(cell.link), report.arm_side,
                  report.controller_side));
  Say(fmt::format("configuration {}", report.config_checksum));
  if (!cell.devices.plc) {
    Say("the cell has no PLC: a request can not be withdrawn there, commands are withheld all the same");
  } else {
    Say(fmt::format("PLC {}:{}", cell.devices.plc->address, cell.devices.plc->port));
    if (!cell.simulated_plc->logic.guard)
      Say("the cell says plc: guard: false: its PLC need not heed this guard");
  }
  Say("Ctrl-C ends it");
}

void PrintEnd(const GuardReport& r) {
  Say(fmt::format("{} messages to the controller, {} answers to the arm; late {}, duplicate {}, withheld {}",
                  r.relayed.to_controller, r.relayed.to_arm, r.judged.late, r.judged.duplicate,
                  r.judged.withheld));
  Say(fmt::format("added latency, p50 / p99 / max: messages {}, answers {}", DelayText(r.message_delay),
                  DelayText(r.answer_delay)));
}

// Decides when a guard that was asked to end may end. With a PLC, the guard first withdraws the motion
// request and continues to relay, so that the controller can bring the arm to rest. If relaying ended at
// once, the arm would miss answers and stop less gently.
class OrderlyEnd {
 public:
  explicit OrderlyEnd(bool has_plc) : has_plc_(has_plc) {}

  /// Whether the guard was asked to end.
  [[nodiscard]] bool began() const { return began_; }
  [[nodiscard]] bool IsReached(const safety::GuardMonitor& monitor, rt::Nanoseconds now) {
    if (!base::Interrupted().load()) return false;
    if (!began_) began_at_ = now;
    began_ = true;
    return !has_plc_ || monitor.latched() || !monitor.ArmIsCommanded(now) || now - began_at_ > kEndWithin;
  }

 private:
  bool has_plc_, began_{false};
  rt::Nanoseconds began_at_{0};
};

// Prints each change of the guard's state once.
class StateChangePrinter {
 public:
  void PrintChanges(const safety::GuardMonitor& monitor) {
    if (monitor.latched() && !latched_)
      fmt::print(
          stderr,
          "osteon guard: {}; nothing goes to the arm any more, the motion request is withdrawn; restart the "
          "guard once the cause is gone\n",
          safety::Describe(monitor.reason()));
    if (!monitor.latched() && monitor.permits() != permits_)
      Say(permits_ ? "the controller has left an arm at rest: the motion request is withdrawn until it "
                     "answers again"
                   : "the controller answers again");
    latched_ = monitor.latched();
    permits_ = monitor.permits();
  }

 private:
  bool latched_{false}, permits_{true};
};

}  // namespace

safety::GuardParams GuardParamsOf(const config::CellConfig& cell) {
  const control::ServoParams& servo = cell.servo;
  const config::GuardConfig& guard = *cell.guard;
  const int multiplier = cell.simulated.fri.receive_multiplier;
  const control::StartParams& start = *servo.start;
  safety::GuardParams params{
      .arm = cell.robot.lbr()->chain,
      .X_WB = cell.X_WB,
      .X_FT = cell.tool.X_FT,
      .period_s = servo.period_s,
      .receive_multiplier = multiplier,
      .joint_speed_share = servo.joints.speed_share,
      .max_speed_m_per_s = servo.twist.max_speed_m_per_s,
      .max_turn_rad_per_s = servo.twist.max_turn_rad_per_s,
      .max_start_path_speed_m_per_s = start.path.tool_speed_m_per_s,
      .max_tracking_error_m = servo.max_tracking_error_m,
      .mirror_rad = cell.link.fri()->entry_step_rad,
      .workspace = servo.workspace,
      .max_force_N = std::min(servo.wrench.max_force_N, safety::kForceCeiling_N),
      .max_torque_Nm = servo.wrench.max_torque_Nm,
      .max_hand_force_N = servo.wrench.max_force_N + servo.sensor_force.margin_N,
      .hand_force_count = servo.sensor_force.ticks,
      .margin = guard.margin,
      .answer_age_s = servo.watchdog.arm_misses * servo.period_s,
      .silence_s = std::max(guard.silence_s, kMinSilenceAnswers * multiplier * servo.period_s)};
  Eigen::Map<kinematics::JointVector>(params.q_start.emplace().data()) = start.q;
  params.tolerance_rad = start.tolerance_rad;
  // The path to the start is limited only by joint speeds. Therefore the tool may rotate as fast as these
  // allow.
  double turn_rad_per_s = 0.0;
  for (const kinematics::RevoluteJoint& joint : params.arm.joints)
    turn_rad_per_s += start.path.speed_share * joint.limits.velocity_rad_per_s;
  params.max_turn_rad_per_s = std::max(params.max_turn_rad_per_s, turn_rad_per_s);
  return params;
}

std::string ToJson(const GuardReport& r) {
  const bool latched = r.reason.finding != safety::GuardFinding::kNone;
  nlohmann::ordered_json json{
      {"schema", "osteon.guard/1"},
      {"version", OSTEON_VERSION},
      {"cell", r.cell},
      {"config_checksum", r.config_checksum},
      {"fri", r.version},
      {"arm_side", r.arm_side},
      {"controller_side", r.controller_side},
      {"relayed", {{"to_controller", r.relayed.to_controller}, {"to_arm", r.relayed.to_arm}}},
      {"withheld", r.judged.withheld},
      {"latched", latched},
      {"reason",
       latched ? nlohmann::ordered_json(safety::Describe(r.reason)) : nlohmann::ordered_json(nullptr)},
      {"late", r.judged.late},
      {"duplicate", r.judged.duplicate},
      {"arm_dropped", r.judged.arm_dropped},
      {"rejected", r.relayed.rejected},
      {"undelivered", r.relayed.undelivered},
      {"added_latency_us",
       {{"to_controller", DelayJson(r.message_delay)}, {"to_arm", DelayJson(r.answer_delay)}}},
      {"realtime_priority", r.thread.realtime},
      {"cpus_awake", r.thread.cpus_awake},
      {"plc", nullptr}};
  if (r.plc)
    json["plc"] = {{"connected", r.plc->link == io::PlcLink::kConnected},
                   {"writes", r.plc->counters.writes},
                   {"lost", r.plc->counters.lost}};
  return base::JsonText(json);
}

int RunGuard(const GuardOptions& options) {
  if (const std::string wrong = rt::ReserveCpu(options.cpu); !wrong.empty())
    return Fail("guard", "--cpu: " + wrong);
  // prints in a thread of its own, so that the relay's thread never waits for the terminal
  OutputThread output;
  base::InstallInterrupt();

  // the guard reads the cell's files itself, so that it does not depend on the controller
  config::CellConfig cell;
  GuardReport report;
  {
    const config::ConfigFileTracker files;
    cell = config::LoadCell(options.cell, options.tool);
    const auto kept = KeepConfig(files, options.cell, options.tool, {});
    if (!kept) return Fail("guard", kept.error());
    report.config_checksum = ConfigChecksum(*kept);
  }
  if (!cell.guard)
    return Fail(
        "guard",
        fmt::format("{}: guard: found no such section, accepted guard: {{port: N}}, where the arm sends to",
                    options.cell.string()));
  if (options.port == 0)
    return Fail("guard", "--port: found 0, accepted the port that the cell was started with");
  if (options.port)
    if (const std::string wrong = UseSimulatedWires(cell, options.port); !wrong.empty())
      return Fail("guard", wrong);
  const std::string controller = cell.link.host == "0.0.0.0" ? "127.0.0.1" : cell.link.host;
  report.cell = options.cell.string();
  report.version = io::Name(cell.link.fri()->version);
  report.arm_side = fmt::format("{}:{}", cell.guard->host, cell.guard->port);
  report.controller_side = fmt::format("{}:{}", controller, cell.link.port);

  const auto monitor = std::make_unique<safety::GuardMonitor>(GuardParamsOf(cell));
  auto relay = io::FriRelay::Open({.arm_address = cell.guard->host,
                                   .arm_port = cell.guard->port,
                                   .arm_host = cell.link.arm_host,
                                   .controller_address = controller,
                                   .controller_port = cell.link.port,
                                   .version = cell.link.fri()->version},
                                  *monitor);
  if (!relay) return Fail("guard", relay.error());
  std::unique_ptr<PlcBeat> plc;
  if (cell.devices.plc) plc = std::make_unique<PlcBeat>(*cell.devices.plc);
  PrintAddresses(cell, report);

  report.thread = rt::SetUpRealtimeThread({.cpu = options.cpu, .lock_memory = true, .keep_cpus_awake = true});
  StateChangePrinter state_changes;
  bool open = true;
  OrderlyEnd end(plc != nullptr);
  while (open && !end.IsReached(*monitor, rt::MonotonicNow())) {
    open = (*relay)->Serve(rt::MonotonicNow() + kPollInterval);
    if (plc) plc->Step(*monitor, end.began());
    state_changes.PrintChanges(*monitor);
  }

  if (plc) report.plc = plc->End();
  report.relayed = (*relay)->counters();
  report.judged = monitor->counters();
  report.reason = monitor->reason();
  report.message_delay = (*relay)->message_delay();
  report.answer_delay = (*relay)->answer_delay();
  PrintEnd(report);
  if (!options.json.empty())
    if (const auto written = base::WriteText(options.json, ToJson(report)); !written)
      return Fail("guard", written.error(), kFailed);
  if (!open) return Fail("guard", "a socket was closed under it", kFailed);
  return monitor->latched() ? kFailed : base::InterruptExitCode(0);
}

}  // namespace osteon::session
