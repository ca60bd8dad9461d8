#include "config/reading/sections/read_stabilisers.h"

namespace osteon::config {
namespace {

// Each function reads one optional section.
void ReadAgeGovernor(Reader section, control::Law law, control::AgeGovernorParams& governor) {
  governor.acts = section.Bool("acts");
  governor.max_damping_factor = section.Number("damping_ratio", 1, 1000);
  governor.release_s = section.Number("release_ms", 1, 10000);
  if (law != control::Law::kImpedance)
    return;  // admittance law: an arm in position mode has no damping of its own that acts on the tool
  if (section.Has("arm_damping_Ns_per_m"))
    governor.arm_damping_Ns_per_m = section.Number("arm_damping_Ns_per_m", 0, 1000);
  if (section.Has("arm_damping_Nms_per_rad"))
    governor.arm_damping_Nms_per_rad = section.Number("arm_damping_Nms_per_rad", 0, 100);
}

void ReadPassivity(Reader section, control::PassivityParams& passivity) {
  passivity.acts = section.Bool("acts");
  passivity.allowance_J = section.Number("allowance_J", 0, 1);
  passivity.min_speed_m_per_s = section.Number("min_speed_mm_per_s", 0.1, 100);
  passivity.max_damping_Ns_per_m = section.Number("damping_Ns_per_m", 0, 10000);
}

void ReadEnergyTank(Reader section, control::EnergyTankParams& tank) {
  tank.acts = section.Bool("acts");
  tank.cap_J = section.Number("cap_J", 0, 100);
  tank.ramp_s = section.Number("ramp_ms", 50, 10000);
}

}  // namespace

void ReadStabilisers(Reader& cell, control::Law law, control::StabiliserParams& stabilisers) {
  if (cell.Has("age_governor")) ReadAgeGovernor(cell.Section("age_governor"), law, stabilisers.age_governor);
  if (cell.Has("passivity")) ReadPassivity(cell.Section("passivity"), stabilisers.passivity);
  if (cell.Has("energy_tank")) ReadEnergyTank(cell.Section("energy_tank"), stabilisers.energy_tank);
}

}  // namespace osteon::config
