#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/planned_cell.h"

namespace osteon::app {

/// Accepted for DemoOptions::seconds.
inline constexpr double kLeastSeconds = 0.1, kMostSeconds = 3600.0;

struct DemoOptions {
  double seconds{10.0};
  std::filesystem::path out{"demo_out"};
  bool overwrite{false};       ///< an earlier demo's files in `out`; else they are moved into a folder there
  std::filesystem::path cell;  ///< the cell's YAML
  std::optional<MeshChoice> mesh{};
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  FidelityChoice fidelity{};                 ///< how fine the bone is
  bool virtual_time{false};
  std::optional<double> frame_ms{};  ///< virtual time: what a frame takes; absent: CellRunParams's
  std::string device{};
  std::string engine{"vulkan"};
  std::optional<std::uint16_t> port{};  ///< instead of the cell's
  int cpu{-1};                          ///< of servo thread and simulated arm, all others stay off; -1: any
  std::filesystem::path json{};         ///< a further copy of summary.json
  std::filesystem::path save_motion{};  ///< the tool's motion, as a file that can be played again
  std::string command_line{};
};

/// The whole cell, simulated: runs it, writes summary.json, report.html and the recording into `out`, prints
/// the summary.
/// @returns the process's exit code: 0 done; 1 ended by a fault, or what was run could not be written; 2
/// something was wrong with the input, nothing was run (both said on stderr); 130 ended by Ctrl-C, 129 by
/// a terminal that was closed, 141 since nobody reads what it prints; everything written.
[[nodiscard]] int RunDemo(const DemoOptions& options);

}  // namespace osteon::app
