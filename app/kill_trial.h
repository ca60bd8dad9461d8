#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::app {

/// What dies, in full contact.
enum class KillVictim {
  kController,  ///< `osteon run`, by SIGKILL
  kLoop,        ///< its servo thread is halted, the rest of it goes on
  kSimulation,  ///< its simulation's thread is halted, the rest of it goes on
  kRecorder,    ///< its recorder's thread is halted, the rest of it goes on
  kGuard,       ///< `osteon guard`, by SIGKILL
  kCell,        ///< `osteon cell`, by SIGKILL: arm, sensor, drive and PLC vanish from their wires at once
};
inline constexpr int kKillVictims = 6;
/// @returns e.g. "controller"
[[nodiscard]] const char* NameOf(KillVictim victim);
/// @returns what is done to it, e.g. "SIGKILL to osteon run"
[[nodiscard]] const char* Describe(KillVictim victim);

struct KillTrialParams {
  std::filesystem::path cell;    ///< a file of WriteKillCell
  double push_N{0.0};            ///< with which its hand presses
  double limit_N{0.0};           ///< of hand and coupling
  std::filesystem::path folder;  ///< for what the processes write; must be there
  std::string device{};          ///< part of a Vulkan device's name
  std::function<bool()> stop{};  ///< asked now and then: end early
};

/// What one death came to. Where the cell dies, arm and hand are gone: then motion and rest are the
/// controller's commands.
struct KillResult {
  KillVictim victim{KillVictim::kController};
  double hand_at_kill_N{0.0};
  bool at_rest{false};
  double rest_ms{0.0};                ///< from the kill until the tool was last faster than rest
  double distance_m{0.0};             ///< of the apex from where it was, at most
  double hand_N{0.0};                 ///< the most that the hand exerted, before and after
  double coupling_N{0.0};             ///< the most that the controller rendered, as far as its recording got
  std::optional<bool> permitted{};    ///< by the PLC, in the end; none: it died
  std::string blocks{};               ///< why it does not permit
  double spindle_rad_per_s{0.0};      ///< in the end, as the drive says
  std::optional<int> run_exit{};      ///< none: it was killed
  std::vector<std::string> faults{};  ///< that the controller named
  std::string guard{};                ///< why the guard withheld, where it did
  int attempts{1};  ///< the others got to no full contact, or stopped for another fault first: a busy machine
  std::string wrong{};  ///< empty: as it has to be

  [[nodiscard]] bool passed() const { return wrong.empty(); }
};

/// Whether the arm was stopped in order, but for another fault than its victim's watchdog names: a busy
/// machine is late in other ways too.
[[nodiscard]] bool AnotherFaultFirst(const KillResult& result);

/// Writes the cell for it, from a shipped one: a guard, a plate of cortical bone that lasts, a hand that
/// presses with `push_N` for some seconds and could do twice as much, a limit of 200 N.
/// @throws std::runtime_error or YAML::Exception naming the file that cannot be read or written.
void WriteKillCell(const std::filesystem::path& source, double push_N, double limit_N,
                   const std::filesystem::path& folder);

/// Starts cell, guard and controller as processes, waits until the arm stands under the hand's full push,
/// lets the victim die, and watches what the simulated cell says of the arm until it has rested for a while.
/// An attempt that got to no full contact, or that another fault stopped in order before the victim's own
/// watchdog could, is made anew, three at most. The error says why there was no trial: a process that cannot
/// be started, no full contact.
[[nodiscard]] tl::expected<KillResult, std::string> RunKillTrial(KillVictim victim,
                                                                 const KillTrialParams& params);

}  // namespace osteon::app
