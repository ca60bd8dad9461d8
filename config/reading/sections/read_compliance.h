#pragma once

#include <array>
#include <optional>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"
#include "simulation/fidelity/compliance_level.h"

namespace osteon::config {

/// Reads a cell's section `compliance`: which of layer, tool and mount give way, and the bone's mount. Call
/// when the bone's place is known. Without the section nothing gives way.
/// @returns the section, for CompleteCompliance
std::optional<Reader> ReadCompliance(Reader& cell_section, CellConfig& cell);

/// Decides which parts with `auto` give way, makes the loop's parameters (ServoParams::compliance), and
/// refuses a loop that would be unstable. Call after robot, tool, scene, materials and script are known.
/// @param section  what ReadCompliance returned; absent: nothing gives way
/// @throws ConfigError naming the value, and the value that is needed.
void CompleteCompliance(const std::optional<Reader>& section, CellConfig& cell);

/// A part of a cell that may give way, and what changes when it does.
struct CompliancePart {
  const char* name{""};  ///< "tool", "layer", "mount"
  GivesWay asked{GivesWay::kOff};
  bool known{false};  ///< false: the cell's files do not say how it gives way
  bool on{false};     ///< it gives way in the loop
  simulation::ComplianceEffect effect{};
  double stiffness_N_per_m{0.0};  ///< of the part; for a layer, the tangent at a first touch under felt_at_N
  double force_N{0.0};            ///< force on the part
  double felt_at_N{0.0};          ///< for a layer: force at which its stiffness is stated; 0: it is linear
  double seated_m2{0.0};          ///< for a layer: area that the tool engages under force_N
  double thrust_ratio{0.0};       ///< for a tool: the push as a share of its buckling load
};

/// The three parts of a cell: tool, layer, mount.
[[nodiscard]] std::array<CompliancePart, 3> CompliancePartsOf(const CellConfig& cell);

}  // namespace osteon::config
