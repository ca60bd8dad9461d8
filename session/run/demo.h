#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "session/planning/planned_cell.h"
#include "session/procedure/prepare_session.h"
#include "session/run/live_views.h"

namespace osteon::session {

/// The accepted range of DemoOptions::seconds.
inline constexpr double kMinSeconds = 0.1, kMaxSeconds = 3600.0;

/// The options of `osteon demo`.
struct DemoOptions {
  double seconds{10.0};                   ///< duration of rendering
  std::filesystem::path out{"demo_out"};  ///< folder for the results
  bool overwrite{false};  ///< remove an earlier demo's files from `out`; false: move them into a folder there
  std::filesystem::path cell;  ///< the cell's YAML
  std::optional<MeshChoice> mesh{};
  std::optional<config::ToolChoice> tool{};  ///< replaces the cell's tool
  std::filesystem::path identified{};        ///< file of `osteon identify`; empty: the cell's own, if any
  FidelityChoice fidelity{};                 ///< how fine the bone is
  /// With a plan: the duration is not `seconds`, but 15 s for each reamer and 20 s more for the last; for a
  /// novice or a burr, 60 s for each tool.
  bool default_seconds{false};
  ProcedureChoice procedure{};  ///< plan whose reamers are used one after the other
  bool virtual_time{false};     ///< run in virtual time, without waiting
  /// Virtual time: duration of a frame; absent: the default of CellRunParams.
  std::optional<double> frame_ms{};
  /// Virtual time: passes at most this many times as fast as real time; absent: as fast as the machine can.
  std::optional<double> real_time_factor{};
  std::string device{};                 ///< part of a Vulkan device's name
  std::string engine{"auto"};           ///< one of EngineNames
  std::optional<std::uint16_t> port{};  ///< first port of the simulated cell; absent: the ports of its file
  int cpu{-1};  ///< for servo thread and simulated arm; all other threads are kept off this CPU; -1: any
  /// After a fault that allows a recovery, the cell stays at rest until an operator requests the recovery.
  bool hold_at_fault{false};
  /// Time between two states of the carved bone in the recording; 0: no states are recorded.
  double bone_state_s{5.0};
  ConsoleChoice console{};              ///< where the console is served
  std::filesystem::path tune{};         ///< result of `osteon tune` for the console; empty: kTuneFile
  ConsoleChoice foxglove{.on = false};  ///< where Foxglove and Lichtblick connect to
  std::filesystem::path json{};         ///< a second copy of summary.json
  std::filesystem::path save_motion{};  ///< file for the tool's motion, which can be played again
  std::filesystem::path surface{};      ///< file for the carved bone as a mesh: STL, PLY or OBJ
  std::string command_line{};           ///< shown in the report
};

/// Runs the whole cell, simulated; writes summary.json, report.html and the recording into `out`, and prints
/// the summary.
/// @returns the process's exit code: 0 done; 1 ended by a fault, or a result could not be written; 2 wrong
/// input, nothing was run (both said on stderr); 130 ended by Ctrl-C, 129 because the terminal was closed,
/// 141 because nobody reads its output any more, each with everything written.
[[nodiscard]] int RunDemo(const DemoOptions& options);

}  // namespace osteon::session
