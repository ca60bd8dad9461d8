#include "studies/kill/kill_trial.h"

#include <algorithm>
#include <csignal>
#include <memory>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/child_process.h"
#include "base/clock.h"
#include "base/halted_thread.h"
#include "config/reading/strict/derived_file.h"
#include "io/recording/recording_reader.h"
#include "safety/fault.h"
#include "session/run/cell_trace.h"
#include "studies/processes/cell_processes.h"

namespace osteon::studies {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;

constexpr int kAttempts = 3;  // maximum number of attempts of a trial
constexpr milliseconds kPollInterval{5};
// Longest waits for full contact, for rest, and for the end of a process that writes report and pages. They
// are generous, so that a busy machine does not decide the outcome.
constexpr seconds kContact{120}, kRest{10}, kEnd{90};
// Full contact: for kFullFor, the hand exerts at least this share of its push, and the tool is slower than
// this speed.
constexpr double kFullShare = 0.97, kPressedIn_m_per_s = 0.01;
constexpr rt::Nanoseconds kFullFor = 100 * rt::kMillisecond;
// Smallest rendered force, as a share of the hand's push, with which a recording shows the contact. A
// recorder that got no time before its process was killed leaves a recording that ends before.
constexpr double kRenderedShare = 0.67;
constexpr double kRest_m_per_s = 0.002;  // greatest speed of a commanded tool that counts as at rest
// Time for which the arm must stay at rest. Within this time the PLC notices missing heartbeats (0.25 s).
constexpr rt::Nanoseconds kRestFor = 800 * rt::kMillisecond;
// Halt of a late engine: long enough that its contact model exceeds every age limit.
constexpr milliseconds kEngineHalt{300};

// Magnitude of a velocity [m/s].
double MetresPerSecond(const PlainVector3& v) { return Vector3(v).norm(); }

// Whether the victim is the engine's process.
bool IsEngine(KillVictim victim) {
  return victim == KillVictim::kEngine || victim == KillVictim::kEngineHung ||
         victim == KillVictim::kEngineLate;
}

// The fault that must be latched when the victim dies; empty: any watchdog may act first.
std::string OwnFault(KillVictim victim) {
  if (victim == KillVictim::kSimulation || IsEngine(victim))
    return safety::Describe(safety::Fault::kModelStale).name;
  if (victim == KillVictim::kRecorder) return safety::Describe(safety::Fault::kRecorder).name;
  return "";
}

// Name of the thread that is halted for this victim.
const char* ThreadOf(KillVictim victim) { return victim == KillVictim::kLoop ? "servo" : NameOf(victim); }

// One trial: the processes of cell, guard and controller, each in a folder of its own.
class Trial {
 public:
  Trial(KillVictim victim, const KillTrialParams& params)
      : params_(params), parts_(params.folder, params.stop), trace_(parts_.Folder("cell") / "trace.csv") {
    parts_.UseCell(IsEngine(victim) ? EngineCell(params.cell) : params.cell);
  }

  /// Starts all processes and waits for full contact. Returns false if full contact was not reached.
  bool ReachFullContact() {
    cell_ = parts_.Start("cell", {"--trace", "trace.csv", "--json", "cell.json", "--console", "off"});
    if (!parts_.AwaitReady("cell", *cell_)) return false;
    guard_ = parts_.Start("guard", {"--json", "guard.json"});
    if (!parts_.AwaitReady("guard", *guard_)) return false;
    std::vector<std::string> more{"--record", "run.mcap", "--json", "run.json", "--engine", params_.engine};
    if (!params_.device.empty()) more.insert(more.end(), {"--device", params_.device});
    run_ = parts_.Start("run", more);
    return Until(kContact,
                 [&] { return IsInFullContact() || run_->Ended() || guard_->Ended() || cell_->Ended(); }) &&
           IsInFullContact() && !run_->Ended();
  }

  /// Kills the victim. @returns why it could not be killed; empty: it was killed
  std::string Kill(KillVictim victim) {
    switch (victim) {
      case KillVictim::kController:
        run_->Send(SIGKILL);
        break;
      case KillVictim::kGuard:
        guard_->Send(SIGKILL);
        break;
      case KillVictim::kCell:
        cell_->Send(SIGKILL);
        break;
      case KillVictim::kLoop:
      case KillVictim::kSimulation:
      case KillVictim::kRecorder: {
        auto halted = base::HaltedThread::Halt(run_->pid(), ThreadOf(victim));
        if (!halted) return halted.error();
        halted_ = std::move(*halted);
        break;
      }
      case KillVictim::kEngine:
      case KillVictim::kEngineHung:
      case KillVictim::kEngineLate:
        engine_ = base::FindChild(run_->pid(), "simulate");
        if (engine_ == 0) return "the controller has no engine's process";
        kill(engine_, victim == KillVictim::kEngine ? SIGKILL : SIGSTOP);
        break;
    }
    killed_ = rt::MonotonicNow();
    if (victim == KillVictim::kEngineLate) {
      std::this_thread::sleep_for(kEngineHalt);
      kill(engine_, SIGCONT);
    }
    return "";
  }

  /// Watches until the arm rests, ends the remaining processes, and collects the result.
  KillResult Watch(KillVictim victim) {
    const bool arm_lives = victim != KillVictim::kCell;
    if (arm_lives) static_cast<void>(Until(kRest, [&] { return RestsFor() > kRestFor; }));
    cell_->Send(SIGTERM);  // end the cell first: what a released thread does then has no effect on it
    cell_->End(kEnd);
    halted_.reset();  // release the halted thread, so that its process can end
    if (victim == KillVictim::kEngineHung) kill(engine_, SIGCONT);
    KillResult result{.victim = victim};
    if (victim == KillVictim::kController)
      run_->End(seconds(0));
    else
      result.run_exit = run_->End(kEnd);
    guard_->Send(SIGTERM);
    guard_->End(kEnd);

    ReadArmTrace(result);
    JudgeRecording(result, !arm_lives);
    CollectReports(result);
    result.wrong = Wrong(result);
    return result;
  }

  /// The last line of the errors of a process that has ended by itself; empty if none has.
  [[nodiscard]] std::string FindComplaint() const {
    for (const auto& [name, process] :
         {std::pair{"cell", cell_.get()}, {"guard", guard_.get()}, {"run", run_.get()}}) {
      if (process && process->Ended()) return parts_.LastError(name);
    }
    return "";
  }

 private:
  // Waits for the condition. Returns false after the time limit, or if the trial is to stop.
  bool Until(milliseconds limit, const std::function<bool()>& condition) {
    const auto give_up = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      if ((params_.stop && params_.stop()) || std::chrono::steady_clock::now() > give_up) return false;
      std::this_thread::sleep_for(kPollInterval);
    }
    return true;
  }

  // Whether the arm has been in full contact for kFullFor, by the newest cycles of the trace.
  bool IsInFullContact() {
    trace_.Poll();
    const auto& cycles = trace_.cycles();
    for (auto cycle = cycles.rbegin(); cycle != cycles.rend(); ++cycle) {
      if (cycle->session != control::SessionState::kCommandingActive ||
          cycle->hand_N < kFullShare * params_.push_N || cycle->speed_m_per_s > kPressedIn_m_per_s)
        return false;
      if (cycles.back().stamp - cycle->stamp > kFullFor) return true;
    }
    return false;
  }

  // Returns the time for which the arm has been at rest since the kill.
  rt::Nanoseconds RestsFor() {
    trace_.Poll();
    return session::RestedFor(trace_.cycles(), killed_);
  }

  // Fills in the hand's force, travel and rest from the simulated arm's trace.
  void ReadArmTrace(KillResult& result) {
    trace_.Poll();
    const session::CellCycle* at_kill = nullptr;
    for (const session::CellCycle& cycle : trace_.cycles()) {
      result.hand_N = std::max(result.hand_N, cycle.hand_N);
      if (cycle.stamp <= killed_) {
        at_kill = &cycle;
        result.hand_at_kill_N = cycle.hand_N;
        continue;
      }
      if (session::Moves(cycle)) result.rest_ms = rt::ToSeconds(cycle.stamp - killed_) * 1e3;
      if (at_kill) result.distance_m = std::max(result.distance_m, (cycle.p_WT_m - at_kill->p_WT_m).norm());
    }
    result.at_rest = at_kill && RestsFor() > kRestFor;
  }

  // Fills in the rendered force from the controller's recording. @param moves  true: the arm's trace has
  // ended, so travel and rest are those of the controller's commands
  void JudgeRecording(KillResult& result, bool moves) {
    const auto recording = io::ReadRecording(parts_.Folder("run") / "run.mcap");
    if (!recording) return;
    std::optional<Vector3> p_at_kill;
    for (const control::TickRecord& tick : recording->ticks) {
      result.coupling_N = std::max(result.coupling_N, Wrench(tick.F_coupling_T_W).f.norm());
      if (!moves) continue;
      const Vector3 p_WT = Pose(tick.X_WT_cmd).translation();
      if (tick.stamp <= killed_) {
        p_at_kill = p_WT;
        continue;
      }
      const double speed = MetresPerSecond(tick.v_WT_cmd_m_per_s);
      if (speed > kRest_m_per_s) result.rest_ms = rt::ToSeconds(tick.stamp - killed_) * 1e3;
      if (p_at_kill) result.distance_m = std::max(result.distance_m, (p_WT - *p_at_kill).norm());
      result.at_rest = speed <= kRest_m_per_s;
    }
  }

  // Fills in the results that controller, guard and cell report at their end.
  void CollectReports(KillResult& result) const {
    if (const nlohmann::json run = parts_.Report("run"); run.is_object())
      result.faults = run.at("faults").get<std::vector<std::string>>();
    result.guard = parts_.ReasonOfGuard();
    if (const auto cell = parts_.ReportOfCell()) {
      result.permitted = cell->plc_permits;
      result.blocks = cell->plc_blocks;
      result.spindle_rad_per_s = cell->spindle_rad_per_s;
    }
  }

  // Lists the requirements that are not met; empty: all are met.
  [[nodiscard]] std::string Wrong(const KillResult& r) const {
    std::string wrong;
    const auto add_if = [&](bool is, const std::string& what) {
      if (is) wrong += (wrong.empty() ? "" : "; ") + what;
    };
    add_if(!r.at_rest, "no rest");
    add_if(r.hand_N > params_.limit_N, fmt::format("the hand felt {:.1f} N", r.hand_N));
    add_if(r.coupling_N > params_.limit_N, fmt::format("{:.1f} N were rendered", r.coupling_N));
    add_if(r.victim != KillVictim::kCell && !r.permitted, "the cell left no report");
    add_if(r.permitted.value_or(false), "the PLC permits motion still");
    // Whether the PLC did not notice that this heartbeat stopped.
    const auto unnoticed = [&r](const char* whose) {
      return r.blocks.find(std::string(whose) + "'s heartbeat lost") == std::string::npos;
    };
    if (r.victim == KillVictim::kController || r.victim == KillVictim::kLoop)
      add_if(unnoticed("controller"), "the PLC did not miss the controller's heartbeat");
    if (r.victim == KillVictim::kGuard)
      add_if(unnoticed("guard"), "the PLC did not miss the guard's heartbeat");
    add_if(std::abs(r.spindle_rad_per_s) > kSpindleStands_rad_per_s, "the spindle turns still");
    if (r.victim != KillVictim::kController) {
      add_if(r.run_exit != 1, fmt::format("the controller ended with {}", r.run_exit.value_or(-1)));
      add_if(r.faults.empty(), "the controller named no fault");
    }
    return wrong;
  }

  const KillTrialParams& params_;
  CellProcesses parts_;
  session::CellTraceReader trace_;
  std::unique_ptr<base::ChildProcess> cell_, guard_, run_;
  // declared after its process, so that it is destroyed before the process
  std::unique_ptr<base::HaltedThread> halted_;
  pid_t engine_{0};
  rt::Nanoseconds killed_{0};
};

// Why a trial that passed says nothing about its victim, as on a busy machine; empty: it does.
std::string WhySpoilt(const KillResult& result, double push_N) {
  if (result.passed() && result.coupling_N < kRenderedShare * push_N)
    return "the recording ends before the contact";
  if (!AnotherFaultFirst(result)) return "";
  return fmt::format("not for \"{}\" but for \"{}\"", OwnFault(result.victim),
                     fmt::join(result.faults, ", "));
}

}  // namespace

bool AnotherFaultFirst(const KillResult& result) {
  const std::string own = OwnFault(result.victim);
  return result.passed() && !own.empty() && result.faults.front() != own;
}

const char* NameOf(KillVictim victim) {
  switch (victim) {
    case KillVictim::kController:
      return "controller";
    case KillVictim::kLoop:
      return "loop";
    case KillVictim::kSimulation:
      return "simulation";
    case KillVictim::kRecorder:
      return "recorder";
    case KillVictim::kGuard:
      return "guard";
    case KillVictim::kCell:
      return "cell";
    case KillVictim::kEngine:
      return "engine";
    case KillVictim::kEngineHung:
      return "engine hung";
    case KillVictim::kEngineLate:
      return "engine late";
  }
  return "unknown";
}

const char* Describe(KillVictim victim) {
  switch (victim) {
    case KillVictim::kController:
      return "SIGKILL to osteon run";
    case KillVictim::kLoop:
      return "the servo thread of osteon run halted";
    case KillVictim::kSimulation:
      return "the simulation's thread of osteon run halted";
    case KillVictim::kRecorder:
      return "the recorder's thread of osteon run halted";
    case KillVictim::kGuard:
      return "SIGKILL to osteon guard";
    case KillVictim::kCell:
      return "SIGKILL to osteon cell: arm, sensor, drive and PLC gone";
    case KillVictim::kEngine:
      return "SIGKILL to osteon simulate, the engine in its own process";
    case KillVictim::kEngineHung:
      return "SIGSTOP to osteon simulate";
    case KillVictim::kEngineLate:
      return "SIGSTOP to osteon simulate, SIGCONT 0.3 s later";
  }
  return "unknown";
}

void WriteKillCell(const std::filesystem::path& source, double push_N, double limit_N,
                   const std::filesystem::path& folder) {
  const std::filesystem::path shipped = source.parent_path() / "../scenes/thin_plate.yaml";
  // 5 mm of cortical bone: with 150 N the drill needs about four seconds to go through. The plate is only as
  // wide as the drill needs, since a smaller plate is packed sooner.
  config::WriteDerived(shipped,
                       {{"shape.height_mm", "5"}, {"shape.width_mm", "16"}, {"shape.depth_mm", "16"}},
                       folder / "plate.yaml");
  const auto number = [](double value) { return fmt::format("{}", value); };
  config::WriteDerived(source,
                       {{"scene", (folder / "plate.yaml").string()},
                        {"plc.guard", "true"},
                        {"guard", "{port: 30209}"},
                        {"limits.max_force_N", number(limit_N)},
                        // enough that the coupling's spring can hold the force limit
                        {"limits.max_stored_J", "0.3"},
                        {"operator.max_force_N", number(2.0 * push_N)},
                        {"script.push_force_N", number(push_N)},
                        {"script.full_force_depth_mm", "15"},
                        {"script.duration_s", "4"}},
                       folder / "cell.yaml");
  config::WriteDerived(folder / "cell.yaml", {{"simulation", "{process: local}"}},
                       EngineCell(folder / "cell.yaml"));
}

std::filesystem::path EngineCell(const std::filesystem::path& cell) {
  return cell.parent_path() / (cell.stem().string() + "_engine.yaml");
}

tl::expected<KillResult, std::string> RunKillTrial(KillVictim victim, const KillTrialParams& params) {
  std::string why;
  for (int attempt = 1; attempt <= kAttempts; ++attempt) {
    Trial trial(victim, params);
    if (!trial.ReachFullContact()) {
      if (params.stop && params.stop()) return tl::make_unexpected("stopped");
      why = trial.FindComplaint();
      continue;
    }
    if (const std::string refused = trial.Kill(victim); !refused.empty()) return tl::make_unexpected(refused);
    KillResult result = trial.Watch(victim);
    result.attempts = attempt;
    if (const std::string spoilt = WhySpoilt(result, params.push_N); !spoilt.empty()) {
      if (attempt < kAttempts) continue;
      result.wrong = fmt::format("{}, in the last of {} attempts", spoilt, kAttempts);
    }
    return result;
  }
  return tl::make_unexpected(fmt::format(
      "no full contact in {} attempts{}", kAttempts,
      why.empty()
          ? ": this machine is too busy; fewer programs beside it, or real-time rights, help (osteon doctor)"
          : ": " + why));
}

}  // namespace osteon::studies
