#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/bone/material.h"

// Constants of the cutting model that were fitted to measurements, with the measurements.

namespace osteon::studies {

/// A constant of a material that determines the force of a cut.
enum class CutConstant : std::uint8_t {
  kCuttingEnergy,      ///< specific cutting energy [J/m³]
  kCuttingForceRatio,  ///< cutting force over normal force
  kEdgeForce,          ///< force of an edge that takes no chip [N/m]; some materials have none
};
/// "cutting_energy", "cutting_force_ratio", "edge_force".
[[nodiscard]] std::string_view NameOf(CutConstant constant);
/// The material's value of this constant, SI.
[[nodiscard]] double ValueOf(const simulation::Material& material, CutConstant constant);

/// A constant that was fitted to measurements; all other constants are assumed.
struct FittedConstant {
  std::string_view file;  ///< under config/materials/
  std::string_view material;
  CutConstant constant{CutConstant::kCuttingEnergy};
  double value{0.0};                        ///< SI, as in the file
  std::string_view how;                     ///< derivation of the value from the measurements
  std::vector<std::string_view> fitted_to;  ///< ids of the measurements
  /// Ids of measurements that also influence the value, but by less than `minor_share` of it.
  std::vector<std::string_view> minor{};
  double minor_share{0.0};

  /// The constant's name, as in "shell.cutting_energy".
  [[nodiscard]] std::string name() const;
};

/// All constants of the shipped materials that were fitted to measurements.
[[nodiscard]] std::span<const FittedConstant> FittedConstants();

/// Whether one of these constants, given by name(), was fitted to the measurement with this id.
[[nodiscard]] bool IsFittedTo(std::span<const std::string> constants, std::string_view measurement);

}  // namespace osteon::studies
