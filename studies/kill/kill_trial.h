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
  kLoop,        ///< the servo thread of `osteon run` is halted; the other threads continue
  kSimulation,  ///< the simulation's thread of `osteon run` is halted; the other threads continue
  kRecorder,    ///< the recorder's thread of `osteon run` is halted; the other threads continue
  kGuard,       ///< `osteon guard`, by SIGKILL
  kCell,        ///< `osteon cell`, by SIGKILL: arm, sensor, drive and PLC fall silent at once
  kEngine,      ///< `osteon simulate`, the engine in its own process, by SIGKILL
  kEngineHung,  ///< `osteon simulate`, halted by SIGSTOP
  kEngineLate,  ///< `osteon simulate`, halted for 0.3 s; then it continues
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
  double limit_N{0.0};           ///< limit of the hand's force and of the coupling's
  std::filesystem::path folder;  ///< existing folder for the files of the processes
  std::string engine{"auto"};    ///< an engine that `osteon run` accepts
  std::string device{};          ///< part of a Vulkan device's name; empty: the default device
  std::function<bool()> stop{};  ///< polled now and then; true ends the trial early
};

/// The result of one kill. If the cell is the victim, arm and hand end with it; travel and rest are then
/// those of the controller's commands.
struct KillResult {
  KillVictim victim{KillVictim::kController};
  double hand_at_kill_N{0.0};  ///< force of the hand in the last cycle before the kill
  bool at_rest{false};         ///< whether the tool was at rest when the trial ended
  double rest_ms{0.0};         ///< time from the kill to the last motion of the tool
  double distance_m{0.0};      ///< greatest distance of the apex from its place at the kill
  double hand_N{0.0};          ///< the hand's greatest force, before and after the kill
  /// The controller's greatest rendered force, until its recording ends.
  double coupling_N{0.0};
  /// Whether the PLC permits motion at the end; nothing: the PLC was killed.
  std::optional<bool> permitted{};
  std::string blocks{};               ///< why the PLC does not permit motion
  double spindle_rad_per_s{0.0};      ///< speed at the end, as the drive reports it
  std::optional<int> run_exit{};      ///< exit code of `osteon run`; nothing: it was killed
  std::vector<std::string> faults{};  ///< names of the faults that the controller reported
  std::string guard{};                ///< why the guard withheld datagrams; empty: it did not
  /// Number of attempts. On a busy machine an attempt is repeated: it never reached full contact, its
  /// recording ends before the contact, or another fault stopped the arm first.
  int attempts{1};
  std::string wrong{};  ///< the requirements that are not met; empty: all are met

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// Whether the arm stopped as required, but because of another fault than the one that the victim's watchdog
/// latches. On a busy machine another watchdog may act first.
[[nodiscard]] bool AnotherFaultFirst(const KillResult& result);

/// Writes the file of the trial's cell, derived from a shipped one. It has a guard; a plate of cortical bone
/// that the drill needs some seconds to go through; a hand that presses with `push_N` for these seconds and
/// could press twice as hard; and the force limit `limit_N`. Also writes the file of the same cell with its
/// engine in a process of its own (EngineCell).
/// @throws std::runtime_error or YAML::Exception naming the file that cannot be read or written.
void WriteKillCell(const std::filesystem::path& source, double push_N, double limit_N,
                   const std::filesystem::path& folder);

/// The file of the cell for those victims that are the engine's process.
[[nodiscard]] std::filesystem::path EngineCell(const std::filesystem::path& cell);

/// Starts cell, guard and controller as processes, waits until the arm is at rest under the hand's full push,
/// kills the victim, and observes the simulated cell until the arm has been at rest for a while. An attempt
/// is repeated, at most three attempts in all, if it never reached full contact, if its recording ends before
/// the contact, or if another fault stopped the arm before the victim's own watchdog acted. The error says
/// why there was no trial: a process cannot be started, or full contact was never reached.
[[nodiscard]] tl::expected<KillResult, std::string> RunKillTrial(KillVictim victim,
                                                                 const KillTrialParams& params);

}  // namespace osteon::studies
