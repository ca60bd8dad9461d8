#include "app/cli/usage/output_paths.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "io/recording/mcap.h"
#include "session/procedure/session_file.h"
#include "simulation/files/carved_file.h"

namespace osteon::app {
namespace {

namespace fs = std::filesystem;

// Options that name a file to be written.
constexpr std::array<std::string_view, 3> kOutputs{"--json", "--save-motion", "--surface"};
// Endings of files that are never JSON, and that people keep and must not lose.
constexpr std::array<std::string_view, 8> kOtherKinds{".mcap", ".carved", ".packed", ".yaml",
                                                      ".yml",  ".stl",    ".ply",    ".obj"};

// Returns "file" or "folder" for an option that names one; empty for any other option.
std::string NamedKind(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.find("FOLDER") != std::string::npos || type.find("DIR") != std::string::npos) return "folder";
  return type.find("FILE") != std::string::npos ? "file" : "";
}

// Returns the kind of an existing file ("a recording") if files of this kind must not be overwritten; empty
// for any other file. The kind is recognised by the file's first bytes or its name.
std::string_view ProtectedKind(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  constexpr std::size_t kHead = 16'384;  // bytes of the beginning that are examined
  std::string head(kHead, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  if (head.starts_with(io::mcap::kMagic)) return "a recording";
  if (head.starts_with(simulation::kCarvedMagic)) return "a carved state";
  if (file.filename() == session::kSessionFileName ||
      head.find(fmt::format("\"{}\"", session::kSessionSchema)) != std::string::npos)
    return "a session";
  return "";
}

// Returns another argument that names the same file; null if there is none.
const CLI::Option* OtherOptionNaming(const CLI::App& asked, const CLI::Option& output, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return nullptr;
  for (const CLI::Option* other : asked.get_options())
    if (other != &output && other->count() > 0)
      for (const std::string& value : other->results())
        if (fs::is_regular_file(value, error) && fs::equivalent(value, file, error)) return other;
  return nullptr;
}

// Returns why the file of an output option must not be written; empty if it may.
std::string OutputError(const CLI::App& asked, const CLI::Option& output) {
  const std::string name = output.get_name(), value = output.results().back();
  const fs::path file(value);
  if (const CLI::Option* other = OtherOptionNaming(asked, output, file))
    return fmt::format("{}: found {}, which {} names as well, accepted another file", name, value,
                       other->get_name());
  if (name != "--surface" && std::ranges::find(kOtherKinds, file.extension().string()) != kOtherKinds.end())
    return fmt::format("{}: found {}, accepted a name that does not end with {}", name, value,
                       file.extension().string());
  if (const std::string_view kind = ProtectedKind(file); !kind.empty())
    return fmt::format("{}: found {}, which is {}, accepted another file", name, value, kind);
  return "";
}

}  // namespace

std::string ValidateOutputPaths(const CLI::App& asked) {
  for (const CLI::Option* option : asked.get_options())
    if (const std::string kind = NamedKind(*option);
        !kind.empty() && std::ranges::find(option->results(), "") != option->results().end())
      return fmt::format("{}: found no name, accepted a {}", option->get_name(), kind);
  for (const CLI::Option* option : asked.get_options())
    if (option->count() > 0 && std::ranges::find(kOutputs, option->get_name()) != kOutputs.end())
      if (std::string wrong = OutputError(asked, *option); !wrong.empty()) return wrong;
  return "";
}

}  // namespace osteon::app
