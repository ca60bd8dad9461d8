#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "session/planning/planned_cell.h"
#include "session/procedure/prepare_session.h"
#include "session/run/live_views.h"

namespace osteon::session {

struct OperateOptions {
  std::filesystem::path cell;  ///< the cell's YAML file
  bool simulated{false};       ///< start the simulated cell, and its guard, as well
  double seconds{0.0};         ///< duration of rendering; 0: until Ctrl-C
  double wait_s{30.0};         ///< longest wait until the arm is there and all conditions of motion hold
  int recoveries{0};           ///< largest number of automatic restarts after lost connections to the arm
  /// Whether a fault that allows a recovery leaves the cell at rest until an operator's recovery or stop;
  /// absent: it does if --console was given, so that a person is expected at the page, and the run has no set
  /// duration.
  std::optional<bool> hold_at_fault{};
  std::filesystem::path record{};            ///< the recording; empty: DatedRecording in the working folder
  bool overwrite{false};                     ///< replace an earlier run's files of this name; false: refuse
  std::optional<config::ToolChoice> tool{};  ///< replaces the cell's tool
  FidelityChoice fidelity{};                 ///< how fine the bone is
  ProcedureChoice procedure{};               ///< plan whose reamers are used one after the other
  std::filesystem::path gains{};             ///< overrides the cell's gains; empty: none
  std::filesystem::path identified{};        ///< file of `osteon identify`; empty: the cell's own, if any
  std::optional<std::uint16_t> port{};       ///< first port of a simulated cell; absent: its file's ports
  int cpu{-1};                               ///< CPU reserved for the servo thread; -1: any
  std::string engine{"auto"};                ///< one of WallTimeEngineNames
  std::string device{};                      ///< part of a Vulkan device's name
  std::filesystem::path surface{};           ///< file for the carved bone as a mesh: STL, PLY or OBJ
  /// Time between two states of the carved bone in the recording; 0: no states are recorded.
  double bone_state_s{5.0};
  ConsoleChoice console{};              ///< where the console is served
  std::filesystem::path tune{};         ///< result of `osteon tune` for the console; empty: kTuneFile
  ConsoleChoice foxglove{.on = false};  ///< where Foxglove and Lichtblick connect to
  std::filesystem::path json{};         ///< file for the summary as JSON; empty: none
  std::string command_line{};           ///< command that repeats the run
};

/// Runs `osteon run`: operates a cell, real or simulated, by the connections that its file names. Leaves the
/// recording, pages of its stops and ReportPage.
/// @returns the process's exit code: 0 done; 1 ended by a fault, never begun, or not recorded; 2 wrong input;
/// 130 ended by Ctrl-C, 129 because the terminal was closed, 141 because nobody reads its output.
[[nodiscard]] int RunOperate(const OperateOptions& options);

}  // namespace osteon::session
