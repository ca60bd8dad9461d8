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

/// A process's use of the machine: memory, open files and threads.
struct ProcessUse {
  double memory_MB{0.0};  ///< resident memory
  int files{0}, threads{0};
};
/// Reads a process's use from /proc; zeros if there is no such process.
[[nodiscard]] ProcessUse UseOf(pid_t process);

/// The processes that a soak watches.
enum class WallPart : std::uint8_t { kController, kEngine, kGuard, kCell, kSoak };
inline constexpr std::array<const char*, 5> kWallParts{"controller", "engine", "guard", "cell", "soak"};
using PartUses = std::array<ProcessUse, kWallParts.size()>;

/// Number of the console's pages that watch a controller. The last one reads no messages, like a page that
/// hangs.
inline constexpr int kWallPages = 3;

/// The data of an episode before it is judged.
struct WallOutcome {
  std::string error{};        ///< why the episode did not take place; empty: it did
  std::optional<int> exit{};  ///< exit code of the controller, in the form that a shell shows
  bool event_done{false};     ///< whether the pauses, the halt or the kill took place
  std::string refused{};      ///< the controller's answer if it refused a request
  std::filesystem::path recording{}, summary{};
  PartUses use{};  ///< last measured use of each process
  /// Use of the controller after half of the episode's time.
  ProcessUse half{};
  std::array<std::uint64_t, kWallPages> messages{};  ///< number of messages that each page got
  /// The report of the cell at its end; absent: the cell still runs, or was killed.
  std::optional<CellReport> cell{};
  std::string guard_reason{};  ///< why the guard withheld datagrams; empty: it did not, or still runs
  double seconds_wall{0.0};
  /// Longest time for which a CPU of this machine did not run the watching thread.
  rt::Nanoseconds cpu_stood_still{0};
};

/// The processes of a cell in wall time: `osteon cell` and `osteon guard`, which run through several
/// episodes, and `osteon run` with its console, which is started for each episode. A process that was killed,
/// or that has a latched fault, is replaced by a new one.
class WallCell {
 public:
  /// @param config_root  folder of the shipped configuration
  /// @param folder  existing folder for the files of the processes
  /// @param stop  polled now and then; true ends an episode early
  WallCell(std::filesystem::path config_root, std::filesystem::path folder, std::function<bool()> stop);

  /// Runs an episode to its end.
  [[nodiscard]] WallOutcome Run(const WallEpisode& episode);

  /// File of the cell that the last episode used.
  [[nodiscard]] std::filesystem::path cell_file() const { return folder_ / "cell.yaml"; }
  /// Makes the next episode start a new cell, because the state of the present one is not known.
  void RequireNewCell() { needs_new_cell_ = true; }

 private:
  class Pages;

  std::string StartCell(const CellLife& life);
  std::string StartGuard();
  void StartController(const WallEpisode& episode);
  // Watches the controller until it has ended, and carries out the actions of the episode's script.
  void WatchController(const WallEpisode& episode, Pages& pages, WallOutcome& outcome);
  [[nodiscard]] PartUses MeasureUses() const;  // present use of each process, in the order of kWallParts
  // Carries out those actions of the script that are due. @param rendered_s  time of rendering so far, as the
  // controller reports it
  void PerformDueActions(const WallEpisode& episode, double rendered_s, WallOutcome& outcome);
  // Sends a request to the controller. If the controller refuses it, its answer is stored in `outcome`, and
  // the next poll repeats the request. @returns whether the request was carried out
  bool Request(const char* request, WallOutcome& outcome);
  // After the controller's end: stores the names of its files in `outcome`, and ends cell and guard if the
  // episode says so.
  void EndParts(const WallEpisode& episode, WallOutcome& outcome);
  void EndCell(WallOutcome& outcome);
  void EndGuard(WallOutcome& outcome);

  // Sends a request to the controller's local socket. @returns its answer
  [[nodiscard]] tl::expected<std::string, std::string> AskController(const std::string& request) const;

  std::filesystem::path config_root_, folder_;
  std::function<bool()> stop_;
  CellProcesses parts_;
  rt::CpuWatch cpus_{90};  // its real-time priority is above those of the servo loop and of the simulated arm
  int life_{-1};           // index of the CellLife whose cell runs
  bool needs_new_cell_{false};
  std::size_t pause_{0};  // index of the script's next pause
  // changed_: the next tool was taken in this pause, or none is to be taken
  bool pausing_{false}, changed_{false};
  double resume_at_s_{0.0};  // time at which the pause ends, on this process's clock
  std::unique_ptr<base::ChildProcess> cell_, guard_, run_;
};

}  // namespace osteon::studies
