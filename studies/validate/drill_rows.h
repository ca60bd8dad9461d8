#pragma once

#include <string>

#include "studies/validate/validation_rows.h"

// Rows that a drill at constant feed simulates.

namespace osteon::studies {

/// [N], at 120 mm/min with a drill of 3.2 mm. Of the shell with the cutting energy that its torque alone
/// gives.
[[nodiscard]] Simulated Thrust(ValidationLab& lab, const std::string& material_name, double rpm);
/// [N mm], mean at 1000, 1250 and 1500 rpm
[[nodiscard]] Simulated MeanTorque(ValidationLab& lab, const std::string& material);
/// At 1500 over 1000 rpm, 120 mm/min
[[nodiscard]] Simulated ThrustSpeedRatio(ValidationLab& lab, const std::string& material,
                                         double diameter_m = 0.0032);
[[nodiscard]] Simulated TorqueSpeedRatio(ValidationLab& lab, const std::string& material,
                                         double diameter_m = 0.0032);
/// Thrust of the epoxy shell, as in Thrust, over human cortex, 1000 rpm
[[nodiscard]] Simulated SawboneOverCortex(ValidationLab& lab);
/// Work for each volume, cancellous bone over foam of 240 kg/m³
[[nodiscard]] Simulated EnergyRatio(ValidationLab& lab);
/// Thrust at 10 µm over 2 µm of depth of cut
[[nodiscard]] Simulated DepthOfCutRatio(ValidationLab& lab);
/// Thrust at four times the cutting speed and the same depth of cut
[[nodiscard]] Simulated CuttingSpeedRatio(ValidationLab& lab);

}  // namespace osteon::studies
