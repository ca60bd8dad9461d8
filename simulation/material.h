#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace osteon::simulation {

/// What the cutting model needs to know of a tissue. `source` says where the figures come from, or "assumed".
struct Material {
  std::string name;
  double density_kg_per_m3{1000.0};
  double specific_cutting_energy_J_per_m3{1e9};  ///< u_c, work of the edge per volume removed
  double cutting_force_ratio{0.8};               ///< mu_c, cutting force over normal force
  double friction{0.2};                          ///< mu of a still tool on it
  std::string source{"assumed"};
};

/// Index into a bone's list of materials.
using MaterialIndex = std::uint8_t;

}  // namespace osteon::simulation
