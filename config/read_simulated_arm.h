#pragma once

#include "config/cell_config.h"
#include "config/reader.h"

namespace osteon::config {

/// What of the section needs the robot.
struct SimulatedArmSection {
  Reader section;
  hil::ArmLevel level{};
  double coulomb_share{0.0};  ///< friction: of a drive's torque limit
  double viscous_share{0.0};  ///< of its torque limit, at its velocity limit
};

/// Section `simulated_arm`, after the link's (ReadArmLink):
///
///     level: kinematic | servo | dynamic, bandwidth_hz, damping_ratio, dead_time_ms, [start_offset_deg]
///     dynamic: {…}, of an LBR
///     monitor_deg, or of cartesian corrections monitor_mm and monitor_deg: where a KR's controller ends RSI,
///     [delay_in_a_row], [ask_again], [start_again_s]
[[nodiscard]] SimulatedArmSection ReadSimulatedArm(Reader section, CellConfig& cell);

/// After Finish() and with the robot read: the simulated arm is the real one, with friction. Refuses a level
/// that needs masses which the robot has not.
void CompleteSimulatedArm(const SimulatedArmSection& section, CellConfig& cell);

}  // namespace osteon::config
