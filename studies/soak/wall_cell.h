#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/child_process.h"
#include "base/cpu_watch.h"
#include "studies/processes/cell_processes.h"
#include "studies/soak/wall_script.h"

namespace osteon::studies {

/// A process's use of the machine.
struct ProcessUse {
  double memory_MB{0.0};  ///< resident
  int files{0}, threads{0};
};
/// Reads a process's use from /proc; zeros if there is no such process.
[[nodiscard]] ProcessUse UseOf(pid_t process);

/// The processes that a soak watches.
enum class WallPart : std::uint8_t { kController, kEngine, kGuard, kCell, kSoak };
inline constexpr std::array<const char*, 5> kWallParts{"controller", "engine", "guard", "cell", "soak"};
using PartUses = std::array<ProcessUse, kWallParts.size()>;

/// Pages of the console that watch a controller; the last one reads nothing, as a page that hangs.
inline constexpr int kWallPages = 3;

/// The data that an episode leaves, before it is judged.
struct WallOutcome {
  std::string error{};        ///< why there was no episode; empty: there was one
  std::optional<int> exit{};  ///< of the controller, as a shell shows it
  bool event_done{false};     ///< the pauses, the halt, or the kill took place
  std::string refused{};      ///< the controller's answer to a request that it refused
  std::filesystem::path recording{}, summary{};
  PartUses use{};                                    ///< last measured use of each process
  ProcessUse half{};                                 ///< use of the controller after half of its time
  std::array<std::uint64_t, kWallPages> messages{};  ///< number of messages that each page got
  /// The cell's report at its end; absent: the cell goes on, or was killed.
  std::optional<CellReport> cell{};
  std::string guard_reason{};  ///< why the guard withheld its permission; empty: it did not, or goes on
  double seconds_wall{0.0};
  rt::Nanoseconds cpu_stood_still{0};  ///< longest time for which a CPU of this machine stood still
};

/// The processes of a cell in wall time: `osteon cell` and `osteon guard`, which live through several
/// episodes, and `osteon run` with its console for each episode. A process that was killed, or that has a
/// latched fault, is started anew.
class WallCell {
 public:
  /// @param config_root  folder of the shipped configuration
  /// @param folder  existing, for the files of the processes
  /// @param stop  polled now and then; true ends an episode early
  WallCell(std::filesystem::path config_root, std::filesystem::path folder, std::function<bool()> stop);

  /// Runs an episode to its end.
  [[nodiscard]] WallOutcome Run(const WallEpisode& episode);

  /// File of the cell that the last episode ran.
  [[nodiscard]] std::filesystem::path cell_file() const { return folder_ / "cell.yaml"; }
  /// Makes the next episode begin with a new cell, because the state of this one is not known.
  void RequireNewCell() { needs_new_cell_ = true; }

 private:
  class Pages;

  std::string StartCell(const CellLife& life);
  std::string StartGuard();
  void StartController(const WallEpisode& episode);
  // Watches the controller until it has ended, and carries out the script's actions.
  void WatchController(const WallEpisode& episode, Pages& pages, WallOutcome& outcome);
  [[nodiscard]] PartUses MeasureUses() const;  // present use of each process, in the order of kWallParts
  // Carries out the script's actions that are due. @param rendered_s  by the controller's clock
  void PerformDueActions(const WallEpisode& episode, double rendered_s, WallOutcome& outcome);
  // Sends a request to the controller. A refusal is kept in `outcome`, and the request is repeated at the
  // next poll. @returns whether the request was carried out
  bool Request(const char* request, WallOutcome& outcome);
  // After the controller's end: names its files in `outcome`, and ends cell and guard if the episode says so.
  void EndParts(const WallEpisode& episode, WallOutcome& outcome);
  void EndCell(WallOutcome& outcome);
  void EndGuard(WallOutcome& outcome);

  // Sends a request to the controller's local socket. @returns its answer
  [[nodiscard]] tl::expected<std::string, std::string> AskController(const std::string& request) const;

  std::filesystem::path config_root_, folder_;
  std::function<bool()> stop_;
  CellProcesses parts_;
  rt::CpuWatch cpus_{90};  // real-time priority above those of the servo loop and the simulated arm
  int life_{-1};           // index of the running cell's life
  bool needs_new_cell_{false};
  std::size_t pause_{0};                  // the next pause of the script
  bool pausing_{false}, changed_{false};  // changed_: this pause has taken the next tool, if it has to
  double resume_at_s_{0.0};               // on this process's clock
  std::unique_ptr<base::ChildProcess> cell_, guard_, run_;
};

}  // namespace osteon::studies
