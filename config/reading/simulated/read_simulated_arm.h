#pragma once

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// Values of the section that are used once the robot is known.
struct SimulatedArmSection {
  Reader section;
  hil::ArmLevel level{};
  double coulomb_share{0.0};  ///< Coulomb friction, as a share of a drive's torque limit
  double viscous_share{0.0};  ///< viscous friction at the velocity limit, as a share of the torque limit
};

/// Reads section `simulated_arm`. Call after ReadArmLink.
///
///     level: kinematic | servo | dynamic, bandwidth_hz, damping_ratio, dead_time_ms, [start_offset_deg]
///     (the dynamic arm rounds its dead time to whole periods)
///     dynamic: {…}, of an LBR
///     monitor_deg, or for Cartesian corrections monitor_mm and monitor_deg: range of the KR's monitor,
///     [delay_in_a_row], [ask_again], [start_again_s]
[[nodiscard]] SimulatedArmSection ReadSimulatedArm(Reader section, CellConfig& cell);

/// Call after Finish() and after the robot is read. Gives the simulated arm the robot's parameters, and adds
/// the friction. Refuses a level that needs masses if the robot's file has no masses.
void CompleteSimulatedArm(const SimulatedArmSection& section, CellConfig& cell);

}  // namespace osteon::config
