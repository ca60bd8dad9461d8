#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "studies/capability/base_placement.h"

namespace osteon::studies {

/// Direction of the base's axis.
enum class Mount { kCell, kFloor, kCeiling };

/// Options of `osteon capability`.
struct CapabilityOptions {
  std::filesystem::path cell;
  std::filesystem::path out{"capability"};
  std::filesystem::path json{};  ///< a second copy of capability.json
  /// Recording of a run, from which the lateral force that the tool needs is taken; empty: it follows from
  /// the cell's limits.
  std::filesystem::path recording{};
  /// A file of `osteon identify`; empty: the file that the cell names, if any.
  std::filesystem::path identified{};
  std::optional<double> axial_N{}, lateral_N{}, radius_mm{};
  double torque_Nm{0.0};
  Mount mount{Mount::kCell};
  /// Ranges of the base's origin in the search, in W.
  std::optional<std::array<double, 2>> x_mm{}, y_mm{}, z_mm{};
  double clearance_mm{350.0};
  double joint_margin_deg{5.0};
  int nodes{61};      ///< number of a map's nodes across the workspace
  bool search{true};  ///< look for a better base
  int threads{2};
  std::string command_line{};
};

/// Runs `osteon capability CELL.yaml`: maps the force that the arm can hold over the cell's task, and
/// searches for the base from which the arm holds the largest force. Writes capability.json, .csv, .html,
/// pictures, and base.yaml into a folder.
/// @returns the process's exit code: 0, whatever the verdict; 1 if a file can't be written; 2 bad input;
/// 130 ended by Ctrl-C.
[[nodiscard]] int RunCapability(const CapabilityOptions& options);

}  // namespace osteon::studies
