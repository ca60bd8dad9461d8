#include "config/derived_file.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <stdexcept>

namespace osteon::config {
namespace {

void Set(YAML::Node node, const std::string& key, const std::string& value) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos)
    node[key] = YAML::Load(value);
  else
    Set(node[key.substr(0, dot)], key.substr(dot + 1), value);
}

}  // namespace

void WriteDerived(const std::filesystem::path& source, const std::vector<YamlEdit>& edits,
                  const std::filesystem::path& target) {
  YAML::Node file = YAML::LoadFile(source.string());
  const std::filesystem::path folder = std::filesystem::absolute(source).parent_path();
  for (auto entry : file) {
    if (!entry.second.IsScalar()) continue;
    const std::filesystem::path named = folder / entry.second.Scalar();
    if (named.extension() == ".yaml") entry.second = named.lexically_normal().string();
  }
  for (const YamlEdit& edit : edits) Set(file, edit.key, edit.value);
  std::ofstream stream(target);
  stream << file << "\n";
  stream.close();
  if (!stream) throw std::runtime_error(target.string() + ": cannot write it");
}

}  // namespace osteon::config
