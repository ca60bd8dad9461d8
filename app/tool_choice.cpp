#include "app/tool_choice.h"

#include <charconv>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

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
  choice.file = name.ends_with(".yaml") ? std::filesystem::path(name) : folder / (name + ".yaml");
  std::error_code error;
  if (std::filesystem::is_regular_file(choice.file, error)) return choice;
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  return tl::make_unexpected(fmt::format("--tool {}: no file {}; accepted: a YAML file, or one of {}: {}",
                                         text, choice.file.string(), folder.string(),
                                         fmt::join(names, ", ")));
}

}  // namespace osteon::app
