#include "studies/validate/fitted_constants.h"

#include <algorithm>

namespace osteon::studies {

std::string_view NameOf(CutConstant constant) {
  switch (constant) {
    case CutConstant::kCuttingEnergy:
      return "cutting_energy";
    case CutConstant::kCuttingForceRatio:
      return "cutting_force_ratio";
    case CutConstant::kEdgeForce:
      break;
  }
  return "edge_force";
}

double ValueOf(const simulation::Material& material, CutConstant constant) {
  switch (constant) {
    case CutConstant::kCuttingEnergy:
      return material.specific_cutting_energy_J_per_m3;
    case CutConstant::kCuttingForceRatio:
      return material.cutting_force_ratio;
    case CutConstant::kEdgeForce:
      break;
  }
  return material.edge_force_N_per_m;
}

std::string FittedConstant::name() const {
  return std::string(material) + "." + std::string(NameOf(constant));
}

std::span<const FittedConstant> FittedConstants() {
  static const std::vector<FittedConstant> constants{
      {.file = "bone.yaml",
       .material = "cortical",
       .constant = CutConstant::kCuttingEnergy,
       .value = 1.3e9,
       .how =
           "power of torque and feed over the volume drilled each second, mean of three speeds: 1.24, 1.31 "
           "and 1.39 J/mm³",
       .fitted_to = {"10-human"},
       .minor = {"8-level", "8-1250", "8-1500"},
       .minor_share = 0.03},
      {.file = "bone.yaml",
       .material = "cortical",
       .constant = CutConstant::kCuttingForceRatio,
       .value = 0.8,
       .how = "torque over thrust and two thirds of the drill's radius, mean of three speeds: 0.88, 0.82 and "
              "0.75",
       .fitted_to = {"10-human", "8-level", "8-1250", "8-1500"}},
      {.file = "bone.yaml",
       .material = "cortical",
       .constant = CutConstant::kEdgeForce,
       .value = 21e3,
       .how = "force on an edge = chip's energy × (depth of cut + 24.7 µm), which rises by 30 % from 2 to 10 "
              "µm; level from the cutting energy at a chip of 48 µm",
       .fitted_to = {"14-depth", "10-human"}},
      {.file = "sawbone.yaml",
       .material = "shell",
       .constant = CutConstant::kCuttingEnergy,
       .value = 0.5e9,
       .how =
           "power of torque and feed over the volume drilled each second, mean of three speeds: 0.45, 0.51 "
           "and 0.53 J/mm³",
       .fitted_to = {"10-sawbone"},
       .minor = {"9-1000", "9-1250", "9-1500"},
       .minor_share = 0.03}};
  return constants;
}

bool IsFittedTo(std::span<const std::string> constants, std::string_view measurement) {
  return std::ranges::any_of(FittedConstants(), [&](const FittedConstant& fitted) {
    return std::ranges::find(constants, fitted.name()) != constants.end() &&
           std::ranges::find(fitted.fitted_to, measurement) != fitted.fitted_to.end();
  });
}

}  // namespace osteon::studies
