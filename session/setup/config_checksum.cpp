#include "session/setup/config_checksum.h"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/fnv1a.h"

namespace osteon::session {

std::string ConfigChecksum(const io::ConfigSource& source) {
  std::vector<std::pair<std::string, std::string_view>> files;
  for (const io::ConfigFile& file : source.files)
    if (file.name != source.gains_file && file.name != source.identified_file)
      files.emplace_back(std::filesystem::path(file.name).filename().string(), file.content);
  std::sort(files.begin(), files.end());
  base::Fnv1a hash;
  for (const auto& [name, content] : files) {
    hash.Add(fmt::format("{}\n{}\n", name, content.size()));
    hash.Add(content);
  }
  return fmt::format("{:016x}", hash.hash());
}

}  // namespace osteon::session
