#include "app/cli/usage/tool_choice.h"

#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "config/reading/named_file.h"
#include "config/reading/strict/nearest_key.h"

namespace osteon::app {
namespace {

/// Suggests the tool that was probably meant: "reamer:54" for "reamer54", "reamer" for "raemer". Empty if no
/// name is similar.
std::string NearestToolName(const std::filesystem::path& folder, const std::string& name,
                            const std::string& diameter) {
  const std::size_t digits_begin = name.find_last_not_of("0123456789.") + 1;
  const std::size_t letters_end = name.substr(0, digits_begin).find_last_not_of("-_ ") + 1;
  if (diameter.empty() && digits_begin > 0 && digits_begin < name.size() && letters_end > 0 &&
      config::FindNamedFile(folder, name.substr(0, letters_end)))
    return name.substr(0, letters_end) + ":" + name.substr(digits_begin);
  std::vector<std::string> names;
  for (const std::filesystem::path& file : config::YamlFilesIn(folder)) names.push_back(file.stem().string());
  const std::string nearest = config::NearestKey(name, names);
  return nearest.empty() ? "" : nearest + diameter;
}

}  // namespace

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
  if (!file) {
    const std::string meant =
        NearestToolName(folder, name, colon == std::string::npos ? "" : text.substr(colon));
    return tl::make_unexpected(fmt::format("--tool {}: no file {}; {}accepted: a YAML file, or one of {}: {}",
                                           text, file.error().string(),
                                           meant.empty() ? "" : "did you mean \"" + meant + "\"? ",
                                           folder.string(), config::YamlNamesIn(folder)));
  }
  choice.file = *file;
  return choice;
}

}  // namespace osteon::app
