#include "app/cli/usage/plan_file.h"

#include <fmt/format.h>

#include "config/reading/named_file.h"

namespace osteon::app {

tl::expected<std::filesystem::path, std::string> FindPlan(const std::filesystem::path& config_root,
                                                          const std::string& name) {
  const std::filesystem::path plans = config_root / "plans";
  return config::FindNamedFile(plans, name).map_error([&](const std::filesystem::path& file) {
    return fmt::format("{}: no file {}; accepted: a YAML file, or one of {}: {}", name, file.string(),
                       plans.string(), config::YamlNamesIn(plans));
  });
}

}  // namespace osteon::app
