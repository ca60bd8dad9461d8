#include "app/config_checksum.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace osteon::app {
namespace {

constexpr std::uint64_t kBasis = 0xcbf29ce484222325u, kPrime = 0x100000001b3u;

}  // namespace

std::string ConfigChecksum(const io::ConfigSource& source) {
  std::vector<std::pair<std::string, std::string_view>> files;
  for (const io::ConfigFile& file : source.files)
    if (file.name != source.gains_file)
      files.emplace_back(std::filesystem::path(file.name).filename().string(), file.content);
  std::sort(files.begin(), files.end());
  std::uint64_t hash = kBasis;
  const auto add = [&hash](std::string_view bytes) {
    for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * kPrime;
  };
  for (const auto& [name, content] : files) {
    add(fmt::format("{}\n{}\n", name, content.size()));
    add(content);
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace osteon::app
