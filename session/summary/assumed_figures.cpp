#include "session/summary/assumed_figures.h"

#include <utility>

#include <fmt/format.h>

#include "config/reading/apply_identified.h"

namespace osteon::session {

std::vector<std::string> AssumedFigures(const config::CellConfig& cell,
                                        std::vector<simulation::Material> materials) {
  const control::ComplianceParams& compliance = cell.servo.compliance;
  if (!compliance.layer)  // a surface layer that is off has no assumed figure
    for (simulation::Material& material : materials) material.layer_N_per_m3 = 0.0;
  std::vector<std::string> lines = simulation::Assumptions(materials);
  if (compliance.tool)
    lines.push_back(fmt::format("{}: time constant of its bending {:g} ms", cell.tool.tool.name,
                                1e3 * compliance.tool->tau_s));
  if (compliance.mount && cell.compliance.mount_source.starts_with("assumed")) {
    const control::BoneMountParams& mount = *compliance.mount;
    std::string creep;
    if (mount.creep_N_per_m > 0.0)
      creep = fmt::format(", creep {:g} N/mm in {:g} s", 1e-3 * mount.creep_N_per_m, mount.creep_tau_s);
    lines.push_back(fmt::format(
        "mount of the bone: {:g} kg, {:g} N/mm, {:g} N m/rad, damping ratio {:g}{} ({})", mount.mass_kg,
        1e-3 * mount.stiffness_N_per_m.minCoeff(), mount.stiffness_Nm_per_rad.minCoeff(), mount.damping_ratio,
        creep, cell.compliance.mount_source));
  }
  return lines;
}

std::vector<std::string> AssumedOfSimulation(const config::CellConfig& cell) {
  std::vector<std::string> lines;
  const config::IdentifiedCell* identified = cell.identified ? &*cell.identified : nullptr;
  const hil::ServoArmParams& arm = cell.simulated.servo;
  if (!(identified && config::SlowestArm(*identified)) && cell.simulated.level != hil::ArmLevel::kKinematic)
    lines.push_back(
        fmt::format("simulated arm: {:g} Hz, damping ratio {:g}, dead time {:g} ms (osteon identify)",
                    arm.bandwidth_hz, arm.damping_ratio, 1e3 * arm.dead_cycles * cell.servo.period_s));
  if (!(identified && identified->sensor && identified->sensor->delay_s))
    lines.emplace_back("own delay of the force sensor: 0 ms (osteon identify)");
  return lines;
}

}  // namespace osteon::session
