#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::studies {

/// The process or thread that is killed or halted in full contact.
enum class KillVictim {
  kController,  ///< `osteon run`, by SIGKILL
  kLoop,        ///< the servo thread of `osteon run` is halted; its other threads go on
  kSimulation,  ///< the simulation's thread of `osteon run` is halted; its other threads go on
  kRecorder,    ///< the recorder's thread of `osteon run` is halted; its other threads go on
  kGuard,       ///< `osteon guard`, by SIGKILL
  kCell,        ///< `osteon cell`, by SIGKILL: arm, sensor, drive and PLC fall silent at once
  kEngine,      ///< `osteon simulate`, the engine in its own process, by SIGKILL
  kEngineHung,  ///< `osteon simulate`, halted by SIGSTOP
  kEngineLate,  ///< `osteon simulate`, halted for 0.3 s; then it goes on
};
inline constexpr int kKillVictims = 9;
/// @returns e.g. "controller"
[[nodiscard]] const char* NameOf(KillVictim victim);
/// @returns how the victim is killed, e.g. "SIGKILL to osteon run"
[[nodiscard]] const char* Describe(KillVictim victim);

/// The cell, engine and folder of a trial.
struct KillTrialParams {
  std::filesystem::path cell;    ///< a file written by WriteKillCell
  double push_N{0.0};            ///< force with which the cell's hand presses
  double limit_N{0.0};           ///< limit for hand and coupling
  std::filesystem::path folder;  ///< existing folder for the files of the processes
  std::string engine{"auto"};    ///< one that `osteon run` accepts
  std::string device{};          ///< part of a Vulkan device's name
  std::function<bool()> stop{};  ///< polled now and then; true ends the trial early
};

/// The outcome of one kill. If the cell is the victim, arm and hand are gone, and motion and rest are those
/// of the controller's commands.
struct KillResult {
  KillVictim victim{KillVictim::kController};
  double hand_at_kill_N{0.0};  ///< force of the hand in the last cycle before the kill
  bool at_rest{false};         ///< the tool was at rest when the trial ended
  double rest_ms{0.0};         ///< from the kill to the last motion of the tool
  double distance_m{0.0};      ///< greatest distance of the apex from its place at the kill
  double hand_N{0.0};          ///< the hand's greatest force, before and after the kill
  /// The controller's greatest rendered force, as far as its recording goes.
  double coupling_N{0.0};
  std::optional<bool> permitted{};    ///< by the PLC at the end; nothing: the PLC was killed
  std::string blocks{};               ///< why the PLC does not permit
  double spindle_rad_per_s{0.0};      ///< at the end, as the drive reports
  std::optional<int> run_exit{};      ///< exit code of `osteon run`; nothing: it was killed
  std::vector<std::string> faults{};  ///< named by the controller
  std::string guard{};                ///< why the guard withheld, if it did
  /// Number of attempts. The earlier ones never reached full contact, or another fault stopped them first,
  /// because the machine was busy.
  int attempts{1};
  std::string wrong{};  ///< empty: as required

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// Whether the arm was stopped in order, but because of another fault than that of the victim's watchdog: on
/// a busy machine, another watchdog may act first.
[[nodiscard]] bool AnotherFaultFirst(const KillResult& result);

/// Writes the cell of the trial, derived from a shipped one: a guard, a plate of cortical bone that lasts, a
/// hand that presses with `push_N` for some seconds and could press twice as hard, a limit of 200 N. Beside
/// it the same cell with its engine in a process of its own (EngineCell).
/// @throws std::runtime_error or YAML::Exception naming the file that cannot be read or written.
void WriteKillCell(const std::filesystem::path& source, double push_N, double limit_N,
                   const std::filesystem::path& folder);

/// The cell of the victims that are the engine's process.
[[nodiscard]] std::filesystem::path EngineCell(const std::filesystem::path& cell);

/// Starts cell, guard and controller as processes, waits until the arm stands under the hand's full push,
/// kills the victim, and observes the simulated cell until the arm has been at rest for a while. An attempt
/// that never reached full contact, or that another fault stopped in order before the victim's own watchdog
/// could, is repeated, at most three times in all. The error says why there was no trial: a process that
/// cannot be started, or no full contact.
[[nodiscard]] tl::expected<KillResult, std::string> RunKillTrial(KillVictim victim,
                                                                 const KillTrialParams& params);

}  // namespace osteon::studies
