#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/bone/material.h"

// Which constant of the cutting model was fitted to which measurement.

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
  std::string_view how;                     ///< how the value follows from the measurements
  std::vector<std::string_view> fitted_to;  ///< ids of measurements
  /// Ids of measurements that change the value by less than `minor_share` of it.
  std::vector<std::string_view> minor{};
  double minor_share{0.0};

  /// "shell.cutting_energy"
  [[nodiscard]] std::string name() const;
};

/// All fitted constants of the shipped materials.
[[nodiscard]] std::span<const FittedConstant> FittedConstants();

/// Whether one of these constants (by name()) was fitted to the measurement.
[[nodiscard]] bool IsFittedTo(std::span<const std::string> constants, std::string_view measurement);

}  // namespace osteon::studies
