#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace osteon::simulation {

/// Index into a bone's list of materials.
using MaterialIndex = std::uint8_t;

/// Longest list of materials that a bone may have.
inline constexpr int kMaxMaterials = 8;

/// Source of a figure or, if no source was found, the reason for its assumed value.
struct FigureSource {
  std::string text;
  bool assumed{true};
};

/// Figures of a tissue for the cutting model, each with its source.
struct Material {
  std::string name;
  double density_kg_per_m3{1000.0};
  double specific_cutting_energy_J_per_m3{1e9};  ///< u_c, work of the edge per removed volume
  double cutting_force_ratio{0.8};               ///< mu_c, cutting force over normal force
  double friction{0.2};                          ///< mu, friction at a tool that does not turn

  FigureSource density_source{}, cutting_energy_source{}, cutting_force_source{}, friction_source{};

  /// Cutting force of an edge that takes no chip, per metre of edge [N/m]: ploughing and rubbing, which do
  /// not depend on the depth of cut. The same number is the work of one pass of the edge per area [J/m²]. 0:
  /// not known.
  double edge_force_N_per_m{0.0};
  /// Chip thickness at which specific_cutting_energy_J_per_m3 was measured. The part edge_force_N_per_m /
  /// measured_chip_m [J/m³] of that energy was due to the edge's force.
  double measured_chip_m{0.0};
  FigureSource edge_force_source{};

  /// Figures of the tissue as a compliant layer on the bone's surface (control/compliance): pressure per
  /// indentation [N/m³], thickness [m], and time constant [s]. 0: the tissue counts as hard.
  double layer_N_per_m3{0.0}, layer_thickness_m{0.0}, layer_relaxation_s{0.0};
  FigureSource layer_source{};
};

/// Checks a bone's materials.
/// @throws std::invalid_argument naming the material, the figure, its value and what is accepted: 1 … 8
///   materials of different names, positive finite figures, friction of 0 … 2, an edge force whose share of
///   the cutting energy is below 1.
void CheckMaterials(const std::vector<Material>& materials);

/// Makes one line for each figure that has no source: "cancellous: friction 0.3 (as cortical bone)".
[[nodiscard]] std::vector<std::string> Assumptions(const std::vector<Material>& materials);

/// Converts the materials for a tool with edge_count cutting edges. The edge force becomes that of all edges
/// together, and the cutting energy becomes that of the chip alone. A material without an edge force keeps
/// its cutting energy. With edge_count 0, all materials keep their cutting energy, and their edge force
/// becomes 0.
[[nodiscard]] std::vector<Material> SplitCuttingEnergy(std::vector<Material> materials, int edge_count);

/// Makes the materials "cartilage", "cortical", "cancellous" and "marrow", in the order of BoneTissue with
/// the figures of config/materials/bone.yaml.
[[nodiscard]] std::vector<Material> DefaultBoneMaterials();

}  // namespace osteon::simulation
