#include "config/reading/strict/key_aliases.h"

#include <yaml-cpp/yaml.h>

#include <array>

namespace osteon::config {
namespace {

constexpr std::array kAliases{
    KeyAlias{"greatest_count", "max_count"},
    KeyAlias{"greatest_surface_gap_mm", "max_surface_gap_mm"},
    KeyAlias{"least_radius_mm", "min_radius_mm"},
    KeyAlias{"least_speed_mm_per_s", "min_speed_mm_per_s"},
    KeyAlias{"least_wall_mm", "min_wall_mm"},
    KeyAlias{"most_N", "max_N"},
    KeyAlias{"most_Nm", "max_Nm"},
};

}  // namespace

std::span<const KeyAlias> KeyAliases() { return kAliases; }

std::string CurrentKey(const std::string& key) {
  for (const KeyAlias& alias : kAliases)
    if (alias.old_name == key) return std::string(alias.name);
  return key;
}

std::string WrittenKey(const YAML::Node& mapping, const std::string& key) {
  const std::string name = CurrentKey(key);
  if (mapping[name].IsDefined()) return name;
  for (const KeyAlias& alias : kAliases)
    if (alias.name == name && mapping[std::string(alias.old_name)].IsDefined())
      return std::string(alias.old_name);
  return key;
}

bool RemoveKey(YAML::Node mapping, const std::string& key) {
  if (!mapping.IsDefined() || !mapping.IsMap()) return false;
  const std::size_t dot = key.find('.');
  const std::string first = key.substr(0, dot);
  if (dot == std::string::npos) return mapping.remove(WrittenKey(mapping, first));
  return RemoveKey(mapping[first], key.substr(dot + 1));
}

}  // namespace osteon::config
