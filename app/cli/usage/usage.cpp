#include "app/cli/usage/usage.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/usage/output_paths.h"
#include "base/text.h"
#include "config/reading/strict/nearest_key.h"

namespace osteon::app {
namespace {

// Accepts a number of type T from min to max.
template <typename T>
CLI::Validator Within(T min, T max) {
  const std::string range = fmt::format("{} … {}", min, max);
  return {[min, max, range](std::string& text) {
            T value{};
            const char* end = text.data() + text.size();
            const auto [rest, error] = std::from_chars(text.data(), end, value);
            const bool good = error == std::errc{} && rest == end && value >= min && value <= max;
            return good ? std::string() : fmt::format("found {}, accepted {}", text, range);
          },
          range};
}

}  // namespace

CLI::Validator NumberWithin(double min, double max) { return Within(min, max); }

CLI::Validator PortNumber() { return Within(0, int{UINT16_MAX}); }

CLI::Validator OneOf(const std::vector<std::string>& words) {
  return {[words](std::string& text) {
            return std::ranges::find(words, text) != words.end()
                       ? std::string()
                       : fmt::format("found {}, accepted {}", text, fmt::join(words, ", "));
          },
          fmt::format("{{{}}}", fmt::join(words, ","))};
}

void AddDeviceOption(CLI::App& sub, std::string& device) {
  sub.add_option("--device", device, "the Vulkan device: part of its name, as `osteon doctor` lists it")
      ->type_name("NAME");
}

void AddEngineOption(CLI::App& sub, std::string& engine, const std::vector<std::string>& names,
                     const std::string& use, const std::string& rest) {
  sub.add_option("--engine", engine, use + "; auto: Vulkan on a GPU, the CPU engine elsewhere" + rest)
      ->check(OneOf(names))
      ->capture_default_str();
}

namespace {

// Returns an option's accepted values in words: "a whole number, 3 … 100", "FROM,TO".
std::string AcceptedOf(const CLI::App& command, const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  std::string type = option ? option->get_type_name() : "";
  // the text before the colon is the type's name, the text after it the range
  const std::size_t colon = type.find(':');
  std::string range = colon == std::string::npos ? "" : ", " + type.substr(colon + 1);
  type = type.substr(0, colon);
  if (type == "INT" || type == "UINT") type = "a whole number";
  if (type == "FLOAT" || type.empty()) type = "a number";
  return type + range;
}

// The beginning of CLI11's error on a path that is missing or of another kind, and the words that replace it.
struct PathWords {
  std::string_view parser, found, accepted;
};
constexpr std::array<PathWords, 4> kPathWords{
    {{"File does not exist: ", "no file", "one that is there"},
     {"File is actually a directory: ", "the folder", "a file"},
     {"Directory does not exist: ", "no folder", "one that is there"},
     {"Directory is actually a file: ", "the file", "a folder"}}};

// Rewrites CLI11's error on a value's type, on a path or on a number of values, so that it says what is
// accepted. Other errors stay unchanged.
std::string WithAccepted(const CLI::App& command, std::string what) {
  constexpr std::string_view kConvert = "Could not convert: ", kReceived = " required but received ";
  if (what.starts_with(kConvert)) {
    const std::string rest = what.substr(kConvert.size());
    const std::size_t equals = rest.find(" = ");
    if (equals == std::string::npos) return what;
    const std::string name = rest.substr(0, equals);
    return fmt::format("{}: found {}, accepted {}", name, rest.substr(equals + 3), AcceptedOf(command, name));
  }
  const std::size_t colon = what.find(": ");
  if (colon == std::string::npos) return what;
  const std::string name = what.substr(0, colon), after = what.substr(colon + 2);
  for (const PathWords& words : kPathWords)
    if (after.starts_with(words.parser))
      return fmt::format("{}: found {} {}, accepted {}", name, words.found, after.substr(words.parser.size()),
                         words.accepted);
  const std::size_t received = what.find(kReceived);
  if (received != std::string::npos)
    return fmt::format("{}: found {} values, accepted {} ({})", name,
                       what.substr(received + kReceived.size()),
                       base::Lower(what.substr(colon + 2, received - colon - 2)), AcceptedOf(command, name));
  if (what.ends_with(" missing"))
    return fmt::format("{}: found no value, accepted {}", name, AcceptedOf(command, name));
  return what;
}

}  // namespace

std::string UsageError(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* deepest = &app;  // `bench frame` is a subcommand of a subcommand
  std::string name = app.get_name();
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = deepest->get_subcommands()) {
    deepest = chosen.front();
    name += " " + deepest->get_name();
  }
  const CLI::App& command = *deepest;

  std::string what = WithAccepted(command, error.what());
  const std::vector<std::string> unknown = app.remaining(true);
  if (!unknown.empty()) {
    // After an unknown option, its value is an unknown word too: report the option rather than the value.
    const auto option = std::ranges::find_if(unknown, [](const auto& word) { return word.starts_with("-"); });
    const bool is_option = option != unknown.end();
    const std::string word = (is_option ? *option : unknown.front()).substr(0, 60);
    std::vector<std::string> known;
    if (is_option) {
      for (const CLI::Option* each : command.get_options()) known.push_back(each->get_name());
    } else {
      for (const CLI::App* each : command.get_subcommands(nullptr)) known.push_back(each->get_name());
    }
    const std::string nearest = config::NearestKey(word.substr(0, word.find('=')), known);
    what = fmt::format("unknown {} {}; {}",
                       is_option                                  ? "option"
                       : command.get_subcommands(nullptr).empty() ? "word"
                                                                  : "subcommand",
                       word,
                       !nearest.empty() ? "did you mean " + nearest + "?"
                       : known.empty()  ? "accepted: options"
                                        : fmt::format("accepted: {}", fmt::join(known, ", ")));
  }
  return fmt::format("{}: {} ({} --help shows all)\n", name, what, name);
}

std::string ValidateEnvironment(const CLI::App& app) {
  const CLI::App* asked = &app;
  std::string name = app.get_name();
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = asked->get_subcommands()) {
    asked = chosen.front();
    name += " " + asked->get_name();
  }
  for (const CLI::Option* option : asked->get_options())
    if (option->get_name() == "--json" && option->count() > 0 && option->results().front() == "-")
      return name + ": --json: found -, accepted a file's name: stdout is for the text\n";
  if (const std::string wrong = ValidateOutputPaths(*asked); !wrong.empty())
    return name + ": " + wrong + "\n";
  std::error_code error;
  static_cast<void>(std::filesystem::temp_directory_path(error));
  if (!error || asked == &app) return "";
  // The variables that std::filesystem reads.
  for (const char* variable : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"})
    if (const char* folder = std::getenv(variable))
      return fmt::format(
          "{}: {}: found {}, which is no folder; accepted one for temporary files, or none: then /tmp\n",
          name, variable, folder);
  return name + ": /tmp: found no such folder, accepted one, or another in TMPDIR\n";
}

}  // namespace osteon::app
