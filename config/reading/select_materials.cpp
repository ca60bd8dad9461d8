#include "config/reading/select_materials.h"

#include <algorithm>

namespace osteon::config {

tl::expected<std::vector<simulation::Material>, std::string> SelectMaterials(
    const std::vector<simulation::Material>& found, const std::vector<std::string>& names) {
  std::vector<simulation::Material> selected;
  for (const std::string& name : names) {
    const auto at =
        std::find_if(found.begin(), found.end(), [&](const auto& material) { return material.name == name; });
    if (at == found.end()) return tl::make_unexpected(name);
    selected.push_back(*at);
  }
  return selected;
}

}  // namespace osteon::config
