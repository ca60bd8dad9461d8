#include "simulation/bone/material.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace osteon::simulation {

void CheckMaterials(const std::vector<Material>& materials) {
  if (materials.empty() || materials.size() > kMaxMaterials)
    throw std::invalid_argument(
        fmt::format("bone: materials: found {}, accepted 1 … {}", materials.size(), kMaxMaterials));
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material& m = materials[i];
    if (m.name.empty())
      throw std::invalid_argument(fmt::format("bone: material {}: found no name, accepted one", i));
    for (std::size_t k = 0; k < i; ++k)
      if (materials[k].name == m.name)
        throw std::invalid_argument(fmt::format(
            "bone: material {}: found name '{}' of material {}, accepted different names", i, m.name, k));
    const auto require_positive = [&m](const char* what, double value) {
      if (!(value > 0.0) || !std::isfinite(value))
        throw std::invalid_argument(
            fmt::format("bone: {}: {}: found {:g}, accepted > 0", m.name, what, value));
    };
    require_positive("density_kg_per_m3", m.density_kg_per_m3);
    require_positive("specific_cutting_energy_J_per_m3", m.specific_cutting_energy_J_per_m3);
    require_positive("cutting_force_ratio", m.cutting_force_ratio);
    if (!(m.friction >= 0.0 && m.friction <= 2.0))
      throw std::invalid_argument(
          fmt::format("bone: {}: friction: found {:g}, accepted 0 … 2", m.name, m.friction));
    if (m.edge_force_N_per_m == 0.0) continue;
    require_positive("measured_chip_m", m.measured_chip_m);
    const double max_edge_force_N_per_m = m.specific_cutting_energy_J_per_m3 * m.measured_chip_m;
    if (!(m.edge_force_N_per_m > 0.0 && m.edge_force_N_per_m < max_edge_force_N_per_m))
      throw std::invalid_argument(fmt::format(
          "bone: {}: edge_force_N_per_m: found {:g}, accepted 0 and more, below {:g}: cutting energy "
          "times measured_chip_m",
          m.name, m.edge_force_N_per_m, max_edge_force_N_per_m));
  }
}

std::vector<Material> SplitCuttingEnergy(std::vector<Material> materials, int edge_count) {
  for (Material& m : materials) {
    if (edge_count <= 0 || m.edge_force_N_per_m <= 0.0) {
      m.edge_force_N_per_m = 0.0;
      continue;
    }
    // subtract the edge's share at the measured chip thickness: the measured energy is that of the chip plus
    // that of the edge
    m.specific_cutting_energy_J_per_m3 -= m.edge_force_N_per_m / m.measured_chip_m;
    m.edge_force_N_per_m *= edge_count;
  }
  return materials;
}

std::vector<std::string> Assumptions(const std::vector<Material>& materials) {
  std::vector<std::string> lines;
  for (const Material& m : materials) {
    const auto add_if_assumed = [&](const FigureSource& source, const std::string& figure) {
      if (source.assumed)
        lines.push_back(fmt::format("{}: {}{}", m.name, figure,
                                    source.text.empty() ? "" : fmt::format(" ({})", source.text)));
    };
    add_if_assumed(m.density_source, fmt::format("density {:g} g/cm³", m.density_kg_per_m3 * 1e-3));
    add_if_assumed(m.cutting_energy_source,
                   fmt::format("cutting energy {:g} J/mm³", m.specific_cutting_energy_J_per_m3 * 1e-9));
    add_if_assumed(m.cutting_force_source, fmt::format("cutting-force ratio {:g}", m.cutting_force_ratio));
    add_if_assumed(m.friction_source, fmt::format("friction {:g}", m.friction));
    if (m.edge_force_N_per_m > 0.0)
      add_if_assumed(m.edge_force_source,
                     fmt::format("edge force {:g} N/mm, cutting energy at a chip of {:g} µm",
                                 1e-3 * m.edge_force_N_per_m, 1e6 * m.measured_chip_m));
    if (m.layer_N_per_m3 > 0.0)
      add_if_assumed(m.layer_source,
                     fmt::format("layer {:g} N/mm³, {:g} mm, {:g} ms", 1e-9 * m.layer_N_per_m3,
                                 1e3 * m.layer_thickness_m, 1e3 * m.layer_relaxation_s));
  }
  return lines;
}

std::vector<Material> DefaultBoneMaterials() {
  const FigureSource as_cortical{.text = "as cortical bone", .assumed = true};
  const FigureSource still_tool{.text = "metal on wet bone, unlubricated", .assumed = true};
  return {
      {.name = "cartilage",
       .density_kg_per_m3 = 1100.0,
       .specific_cutting_energy_J_per_m3 = 0.02e9,
       .cutting_force_ratio = 0.8,
       .friction = 0.05,
       .density_source = {.text = "a little above water", .assumed = true},
       .cutting_energy_source = {.text = "softer than cancellous bone: a third", .assumed = true},
       .cutting_force_source = as_cortical,
       .friction_source = {.text = "lubricated", .assumed = true}},
      {.name = "cortical",
       .density_kg_per_m3 = 1850.0,
       .specific_cutting_energy_J_per_m3 = 1.3e9,
       .cutting_force_ratio = 0.8,
       .friction = 0.3,
       .density_source = {.text = "middle of 1.7 to 2.0 g/cm^3, reported for human cortical bone",
                          .assumed = false},
       .cutting_energy_source = {.text =
                                     "human femoral cortex, 1.24 to 1.39 J/mm^3, from the drilling figures "
                                     "of MacAvelia et al. 2012",
                                 .assumed = false},
       .cutting_force_source = {.text = "0.75 to 0.88 at two thirds of the radius, from the same drilling "
                                        "figures",
                                .assumed = false},
       .friction_source = still_tool,
       .edge_force_N_per_m = 21e3,
       .measured_chip_m = 48e-6,
       .edge_force_source = {.text =
                                 "thrust + 30 % from 2 to 10 um of depth of cut, a saw's single tooth, James "
                                 "et al. 2013; chip of a lip in the drilling figures, harmonic mean of three",
                             .assumed = false}},
      {.name = "cancellous",
       .density_kg_per_m3 = 300.0,
       .specific_cutting_energy_J_per_m3 = 0.06e9,
       .cutting_force_ratio = 0.8,
       .friction = 0.3,
       .density_source = {.text = "upper half of 0.09 to 0.35 g/cm^3, reported for vertebral trabecular bone",
                          .assumed = false},
       .cutting_energy_source =
           {.text = "between cortical bone's scaled by density, 0.21, and by its square, 0.03",
            .assumed = true},
       .cutting_force_source = as_cortical,
       .friction_source = still_tool},
      {.name = "marrow",
       .density_kg_per_m3 = 980.0,
       .specific_cutting_energy_J_per_m3 = 0.001e9,
       .cutting_force_ratio = 0.8,
       .friction = 0.05,
       .density_source = {.text = "yellow marrow, from memory of ICRU Report 46: not looked up",
                          .assumed = true},
       .cutting_energy_source = {.text = "all but none, so that a tool falls into the canal",
                                 .assumed = true},
       .cutting_force_source = as_cortical,
       .friction_source = {.text = "lubricated", .assumed = true}},
  };
}

}  // namespace osteon::simulation
