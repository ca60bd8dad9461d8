#pragma once

#include <array>
#include <optional>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"
#include "simulation/fidelity/compliance_level.h"

namespace osteon::config {

/// Reads a cell's section `compliance`: which of layer, tool and mount are compliant, and the parameters of
/// the bone's mount. Call after the bone's pose is read. Without the section, all parts are rigid.
/// @returns the section, for CompleteCompliance
std::optional<Reader> ReadCompliance(Reader& cell_section, CellConfig& cell);

/// Decides which parts with `auto` are compliant, makes the loop's parameters (ServoParams::compliance), and
/// refuses parameters with which the loop would be unstable. Call after robot, tool, scene, materials and
/// script are read.
/// @param section  result of ReadCompliance; absent: all parts are rigid
/// @throws ConfigError naming the value, and the value that is needed.
void CompleteCompliance(const std::optional<Reader>& section, CellConfig& cell);

/// A part of a cell that may be compliant, and the effect of its compliance.
struct CompliancePart {
  const char* name{""};  ///< "tool", "layer", "mount"
  GivesWay asked{GivesWay::kOff};
  bool known{false};  ///< the cell's files state its stiffness
  bool on{false};     ///< the part is compliant in the loop
  simulation::ComplianceEffect effect{};
  double stiffness_N_per_m{0.0};  ///< stiffness of the part; for a layer, the tangent stiffness at a first
                                  ///< touch with the force felt_at_N
  double force_N{0.0};            ///< force on the part
  double felt_at_N{0.0};     ///< for a layer: force at which stiffness_N_per_m holds; 0 for a linear part
  double seated_m2{0.0};     ///< for a layer: area that the tool engages under force_N
  double thrust_ratio{0.0};  ///< for a tool: the push as a share of its buckling load
};

/// The three parts of a cell: tool, layer, mount.
[[nodiscard]] std::array<CompliancePart, 3> CompliancePartsOf(const CellConfig& cell);

}  // namespace osteon::config
