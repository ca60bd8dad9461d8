#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteon::config {

/// One value that differs from the source file.
struct YamlEdit {
  std::string key;    ///< "limits.max_force_N": of a section; created if missing
  std::string value;  ///< as YAML: "150", "{port: 30209}"
};

/// Writes a configuration file that differs from its source in some values. Files that the source names by a
/// relative path or by a name alone are written as absolute paths. A cell that extends another one (Reader)
/// is written with all values of both. Comments are lost.
/// @throws YAML::Exception or std::runtime_error naming the file that could not be read or written.
void WriteDerived(const std::filesystem::path& source, const std::vector<YamlEdit>& edits,
                  const std::filesystem::path& target);

}  // namespace osteon::config
