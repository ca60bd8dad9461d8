#include "plugin/src/shipped_files.h"

#include <dlfcn.h>

#include <array>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "config/reading/load_materials.h"
#include "config/reading/named_file.h"
#include "config/reading/select_materials.h"
#include "config/reading/shipped_folder.h"
#include "plugin/src/result.h"

namespace osteon::plugin {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 2> kRequiredFolders{"scenes", "tools"};

bool HasRequiredFolders(const fs::path& config) { return config::HasFolders(config, kRequiredFolders); }

// Path of the library file that contains this code; empty if the system cannot tell.
fs::path LibraryFile() {
  Dl_info info{};
  std::error_code ignored;
  if (dladdr(reinterpret_cast<const void*>(&ConfigFolder), &info) == 0 || !info.dli_fname) return {};
  return fs::weakly_canonical(info.dli_fname, ignored);
}

}  // namespace

fs::path ConfigFolder(const char* given) {
  if (given) {
    if (!HasRequiredFolders(given))
      throw Failure(OSTEON_ERROR_FILE,
                    fmt::format("config_folder: found {}, accepted a folder with scenes/ and tools/", given));
    return given;
  }
  if (const char* root = std::getenv("OSTEON_ROOT"); root && HasRequiredFolders(fs::path(root) / "config"))
    return fs::path(root) / "config";
  const fs::path library = LibraryFile();
  if (fs::path found = config::FindShippedAbove(library, kRequiredFolders); !found.empty()) return found;
  throw Failure(OSTEON_ERROR_FILE,
                fmt::format("no folder with scenes/ and tools/ above {}: set config_folder, or $OSTEON_ROOT",
                            library.string()));
}

fs::path FindShipped(const fs::path& config, const std::string& kind, const std::string& name) {
  const auto file = config::FindNamedFile(config / kind, name);
  if (!file)
    throw Failure(OSTEON_ERROR_FILE,
                  fmt::format("no file {}; accepted: a YAML file, or one of {}: {}", file.error().string(),
                              (config / kind).string(), config::YamlNamesIn(config / kind)));
  return *file;
}

std::vector<simulation::Material> FindMaterials(const fs::path& config,
                                                const std::vector<std::string>& names) {
  for (const fs::path& file : config::YamlFilesIn(config / "materials"))
    if (auto selected = config::SelectMaterials(config::LoadMaterials(file), names))
      return std::move(*selected);
  throw Failure(OSTEON_ERROR_FILE, fmt::format("no file of {} has all of {}", (config / "materials").string(),
                                               fmt::join(names, ", ")));
}

}  // namespace osteon::plugin
