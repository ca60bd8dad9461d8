#include "config/reading/load_materials.h"

#include <fmt/format.h>

#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

// Reads the force of a cutting edge per length of the edge. CheckEdgeForce limits it.
void ReadEdgeForce(Reader& tissue, simulation::Material& material) {
  material.edge_force_N_per_m = tissue.Number("edge_force_N_per_mm", 1e-3, 1e3);
  material.measured_chip_m = tissue.Number("measured_chip_um", 0.1, 1e4);
  material.edge_force_source = {.text = tissue.Text("edge_force_source"),
                                .assumed = tissue.Bool("edge_force_assumed")};
}

// Refuses an edge force that alone would need the whole specific cutting energy. The measured energy includes
// the work of the edge force, so this work must be smaller.
void CheckEdgeForce(const Reader& tissue, const simulation::Material& material) {
  const double max_N_per_m = material.specific_cutting_energy_J_per_m3 * material.measured_chip_m;
  if (material.edge_force_N_per_m > 0.0 && material.edge_force_N_per_m >= max_N_per_m)
    tissue.Refuse("edge_force_N_per_mm",
                  fmt::format("found {:.10g}, accepted less than {:.4g}: cutting_energy_J_per_mm3 times "
                              "measured_chip_um",
                              1e-3 * material.edge_force_N_per_m, 1e-3 * max_N_per_m));
}

}  // namespace

std::vector<simulation::Material> LoadMaterials(const std::filesystem::path& path) {
  Reader reader = Reader::Load(path);
  std::vector<Reader> list = reader.Sections("materials", 1, simulation::kMaxMaterials);
  std::vector<simulation::Material> materials;
  for (Reader& tissue : list) {
    const auto source = [&tissue](const std::string& figure) {
      return simulation::FigureSource{.text = tissue.Text(figure + "_source"),
                                      .assumed = tissue.Bool(figure + "_assumed")};
    };
    materials.push_back(
        {.name = tissue.Text("name"),
         .density_kg_per_m3 = tissue.Number("density_g_per_cm3", 0.01, 10),
         .specific_cutting_energy_J_per_m3 = tissue.Number("cutting_energy_J_per_mm3", 1e-4, 100),
         .cutting_force_ratio = tissue.Number("cutting_force_ratio", 0.01, 5),
         .friction = tissue.Number("friction_ratio", 0, 2),
         .density_source = source("density"),
         .cutting_energy_source = source("cutting_energy"),
         .cutting_force_source = source("cutting_force"),
         .friction_source = source("friction")});
    simulation::Material& material = materials.back();
    if (tissue.Has("edge_force_N_per_mm")) ReadEdgeForce(tissue, material);
    if (!tissue.Has("layer_N_per_mm3")) continue;
    material.layer_N_per_m3 = tissue.Number("layer_N_per_mm3", 1e-4, 1e4);
    material.layer_thickness_m = tissue.Number("layer_thickness_mm", 0.05, 50);
    material.layer_relaxation_s = tissue.Number("layer_relaxation_ms", 1, 100'000);
    material.layer_source = source("layer");
  }
  reader.Finish();
  for (std::size_t i = 0; i < materials.size(); ++i) CheckEdgeForce(list[i], materials[i]);
  for (std::size_t i = 0; i < materials.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (materials[k].name == materials[i].name)
        list[i].Refuse("name", fmt::format("found {} again, accepted another name", materials[i].name));
  return materials;
}

}  // namespace osteon::config
