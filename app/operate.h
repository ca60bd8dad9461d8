#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/planned_cell.h"

namespace osteon::app {

struct OperateOptions {
  std::filesystem::path cell;  ///< its YAML
  bool simulated{false};       ///< start the simulated cell as well, and its guard
  double seconds{0.0};         ///< of rendering; 0: until Ctrl-C
  double wait_s{30.0};         ///< for the arm and all conditions of motion, until rendering begins
  int recoveries{0};  ///< so often it begins again after the connection to the arm has ended rendering
  std::filesystem::path record{};  ///< the recording; empty: DatedRecording in the working folder
  bool overwrite{false};           ///< an earlier run's files of that name; else they are a reason to refuse
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  FidelityChoice fidelity{};                 ///< how fine the bone is
  std::filesystem::path gains{};             ///< a file to lay over the cell's gains; empty: none
  std::optional<std::uint16_t> port{};       ///< of a simulated cell: the first of its ports
  int cpu{-1};           ///< the servo thread is pinned to it, all others stay off; -1: any
  std::string device{};  ///< part of a Vulkan device's name
  std::filesystem::path json{};
};

/// `osteon run`: operates a cell, real or simulated, by what is on the wires that its file names.
/// @returns the process's exit code: 0 done; 1 ended by a fault, never begun, or not recorded; 2 something
/// was wrong with the input; 130 ended by Ctrl-C, 129 by a terminal that was closed, 141 since nobody reads
/// what it prints.
[[nodiscard]] int RunOperate(const OperateOptions& options);

}  // namespace osteon::app
