#include "config/reading/strict/derived_file.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <stdexcept>
#include <utility>

#include "config/reading/config_file_tracker.h"
#include "config/reading/strict/key_aliases.h"

namespace osteon::config {
namespace {

// Sets one value of a mapping, creating missing sections. @param key  "limits.max_force_N"
void SetValue(YAML::Node node, const std::string& key, const std::string& value) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos)
    node[WrittenKey(node, key)] = YAML::Load(value);
  else
    SetValue(node[key.substr(0, dot)], key.substr(dot + 1), value);
}

// Copies each value of `values` into `node`, section by section. A list is replaced as a whole.
void Merge(const YAML::Node& values, YAML::Node node) {
  for (const auto& entry : values) {
    const std::string key = WrittenKey(node, entry.first.Scalar());
    if (entry.second.IsMap() && node[key] && node[key].IsMap())
      Merge(entry.second, node[key]);
    else
      node[key] = entry.second;
  }
}

// Replaces the names of files in a mapping by absolute paths. @param source  the file that has the mapping
void UseWholePaths(YAML::Node file, const std::filesystem::path& source) {
  const std::filesystem::path folder = std::filesystem::absolute(source).parent_path();
  for (auto entry : file) {
    if (!entry.second.IsScalar()) continue;
    const std::filesystem::path named = folder / entry.second.Scalar();
    if (named.extension() == ".yaml") entry.second = named.lexically_normal().string();
  }
  for (const auto& [key, kind] :
       {std::pair("robot", "robots"), {"tool", "tools"}, {"scene", "scenes"}, {"materials", "materials"}}) {
    if (!file[key] || !file[key].IsScalar()) continue;
    const std::filesystem::path found = ConfigFileTracker::FindByName(source, kind, file[key].Scalar());
    if (!found.empty()) file[key] = std::filesystem::absolute(found).string();
  }
}

// Reads a file. If it extends another file, returns the other file's content with this file's values merged
// into it.
YAML::Node LoadMerged(const std::filesystem::path& source) {
  YAML::Node file = YAML::LoadFile(source.string());
  UseWholePaths(file, source);
  if (!file["extends"]) return file;
  const std::string base_name = file["extends"].Scalar();
  // UseWholePaths has made it absolute, unless it is a name without a path
  std::filesystem::path base_file = base_name;
  if (!base_name.ends_with(".yaml")) base_file = ConfigFileTracker::FindByName(source, "cells", base_name);
  YAML::Node base = YAML::LoadFile(base_file.string());
  UseWholePaths(base, base_file);
  for (const auto& key : file["remove"]) RemoveKey(base, key.Scalar());
  file.remove("extends");
  file.remove("remove");
  Merge(file, base);
  return base;
}

}  // namespace

void WriteDerived(const std::filesystem::path& source, const std::vector<YamlEdit>& edits,
                  const std::filesystem::path& target) {
  YAML::Node file = LoadMerged(source);
  for (const YamlEdit& edit : edits) SetValue(file, edit.key, edit.value);
  std::ofstream stream(target);
  stream << file << "\n";
  stream.close();
  if (!stream) throw std::runtime_error(target.string() + ": cannot write it");
}

}  // namespace osteon::config
