#pragma once

#include <string>

#include "studies/validate/validation_rows.h"

// Rows of `osteon validate` that a drill at constant feed simulates.

namespace osteon::studies {

/// Thrust [N] at 120 mm/min with a drill of 3.2 mm. For the epoxy shell, the cutting energy is the one that
/// follows from its torque alone.
[[nodiscard]] Simulated Thrust(ValidationLab& lab, const std::string& material_name, double rpm);
/// Mean of the torques at 1000, 1250 and 1500 rpm [N mm].
[[nodiscard]] Simulated MeanTorque(ValidationLab& lab, const std::string& material);
/// Ratio of the thrust at 1500 rpm to that at 1000 rpm, at 120 mm/min; below, the same ratio of the torque.
[[nodiscard]] Simulated ThrustSpeedRatio(ValidationLab& lab, const std::string& material,
                                         double diameter_m = 0.0032);
[[nodiscard]] Simulated TorqueSpeedRatio(ValidationLab& lab, const std::string& material,
                                         double diameter_m = 0.0032);
/// Ratio of the epoxy shell's thrust (cutting energy as in Thrust) to the thrust in human cortex, at 1000
/// rpm.
[[nodiscard]] Simulated SawboneOverCortex(ValidationLab& lab);
/// Ratio of the work per volume in cancellous bone to that in foam of 240 kg/m³.
[[nodiscard]] Simulated EnergyRatio(ValidationLab& lab);
/// Ratio of the thrust at 10 µm depth of cut to that at 2 µm.
[[nodiscard]] Simulated DepthOfCutRatio(ValidationLab& lab);
/// Ratio of the thrust at 2000 rpm to that at 500 rpm, at the same depth of cut.
[[nodiscard]] Simulated CuttingSpeedRatio(ValidationLab& lab);

}  // namespace osteon::studies
