#include "app/tool_choice.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "config/named_file.h"

namespace osteon::app {

tl::expected<config::ToolChoice, std::string> ParseTool(const std::string& text,
                                                        const std::filesystem::path& config_root) {
  config::ToolChoice choice;
  const std::size_t colon = text.rfind(':');
  const std::string name = text.substr(0, colon);
  if (colon != std::string::npos) {
    const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
    double diameter_mm = 0.0;
    const auto [rest, error] = std::from_chars(begin, end, diameter_mm);
    if (error != std::errc{} || rest != end || !(std::isfinite(diameter_mm) && diameter_mm > 0.0))
      return tl::make_unexpected(
          fmt::format("--tool {}: found \"{}\", accepted a diameter in mm", text, std::string(begin, end)));
    choice.diameter_m = diameter_mm * 1e-3;
  }
  const std::filesystem::path folder = config_root / "tools";
  const auto file = config::FindNamedFile(folder, name);
  if (!file)
    return tl::make_unexpected(fmt::format("--tool {}: no file {}; accepted: a YAML file, or one of {}: {}",
                                           text, file.error().string(), folder.string(),
                                           config::YamlNamesIn(folder)));
  choice.file = *file;
  return choice;
}

}  // namespace osteon::app
