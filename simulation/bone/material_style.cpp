#include "simulation/bone/material_style.h"

#include <string>
#include <string_view>

namespace osteon::simulation {
namespace {

// The colours of a material whose name contains a word; the first word that fits decides.
struct NamedStyle {
  std::string_view word;  ///< part of the material's name
  MaterialStyle style;
};
constexpr std::array<NamedStyle, 11> kNamedStyles{{{"cartilage", {"#d3e6f3", {0.76, 0.87, 0.94}}},
                                                   {"subchondral", {"#efe0b4", {0.95, 0.89, 0.72}}},
                                                   {"cortical", {"#efe0b4", {0.95, 0.89, 0.72}}},
                                                   {"cancellous", {"#f4cfb4", {0.88, 0.64, 0.50}}},
                                                   {"trabecular", {"#f4cfb4", {0.88, 0.64, 0.50}}},
                                                   {"marrow", {"#f3dc9c", {0.90, 0.72, 0.36}}},
                                                   {"enamel", {"#e3ebf4", {0.93, 0.94, 0.95}}},
                                                   {"dentine", {"#f3e3bf", {0.94, 0.84, 0.64}}},
                                                   {"pulp", {"#f2bcb8", {0.82, 0.38, 0.36}}},
                                                   {"shell", {"#d6e2cf", {0.74, 0.80, 0.66}}},
                                                   {"foam_20", {"#f1e2b8", {0.90, 0.80, 0.56}}}}};
// For materials with other names, by their index.
constexpr std::array<MaterialStyle, 4> kOtherStyles{{{"#e2d9ee", {0.78, 0.72, 0.86}},
                                                     {"#d6ead3", {0.72, 0.84, 0.70}},
                                                     {"#f0d7e0", {0.88, 0.70, 0.76}},
                                                     {"#e6e6e6", {0.80, 0.80, 0.80}}}};

}  // namespace

const MaterialStyle& StyleOf(const std::vector<Material>& materials, MaterialIndex material) {
  if (material < materials.size())
    for (const NamedStyle& named : kNamedStyles)
      if (materials[material].name.find(named.word) != std::string::npos) return named.style;
  return kOtherStyles[material % kOtherStyles.size()];
}

}  // namespace osteon::simulation
