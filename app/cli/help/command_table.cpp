#include "app/cli/help/command_table.h"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

constexpr auto kCommonExitCodes = std::to_array<std::pair<int, std::string_view>>({
    {0, "done"},
    {session::kFailed, "the requested work failed; the section of the subcommand says when"},
    {session::kBadInput, "wrong usage or bad input; nothing was started"},
    {session::kInternalError, "a defect of the program: please report it"},
    {session::kNoMemory, "out of memory"},
    {129, "the terminal was closed (SIGHUP); the work ended in order"},
    {130, "ended by Ctrl-C, in order"},
    {141, "nobody reads the output any more"},
});

// Returns the command's full name, e.g. "osteon bench frame".
std::string NameOf(const CLI::App& app) {
  return app.get_parent() ? NameOf(*app.get_parent()) + " " + app.get_name() : app.get_name();
}

// Returns the help's word for one of CLI11's types.
std::string KindOfValue(const std::string& type) {
  if (type == "FLOAT") return "NUMBER";
  if (type == "INT" || type == "UINT") return "N";
  return type;
}

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

// Returns the names in the order of the options' definition. CLI11's set is ordered by address, which differs
// from run to run.
std::vector<std::string> NamesInOrder(const std::vector<const CLI::Option*>& all,
                                      const std::set<CLI::Option*>& chosen) {
  std::vector<std::string> names;
  for (const CLI::Option* option : all)
    if (std::ranges::find(chosen, option) != chosen.end()) names.push_back(option->get_name());
  return names;
}

// Converts one of CLI11's options. @param all  the options of its command
OptionText DescribeOption(const CLI::Option& option, const std::vector<const CLI::Option*>& all) {
  OptionText text{.names = {},
                  .is_argument = option.get_positional() && !option.nonpositional(),
                  .required = option.get_required(),
                  .repeats = option.get_expected_max() >= CLI::detail::expected_max_vector_size,
                  .value = "",
                  .words = {},
                  .range = "",
                  .help = option.get_description(),
                  .default_value = "",
                  .group = option.get_group(),
                  .needs = NamesInOrder(all, option.get_needs()),
                  .excludes = NamesInOrder(all, option.get_excludes())};
  if (text.is_argument) {
    text.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  if (option.get_items_expected_max() == 0) return text;  // a flag
  text.default_value = option.get_default_str();
  // The type's name, then what its validators accept: "TEXT:{a,b}", "FLOAT:1 … 100".
  const std::vector<std::string> type = Split(option.get_type_name(), ':');
  if (!type.empty()) text.value = KindOfValue(type[0]);
  for (std::size_t i = 1; i < type.size(); ++i) {
    if (type[i].starts_with('{') && type[i].ends_with('}'))
      text.words = Split(type[i].substr(1, type[i].size() - 2), ',');
    else if (type[i] != type[0])
      text.range = type[i];
  }
  if (!text.words.empty()) text.value = "WORD";
  return text;
}

}  // namespace

void ParseFooter(const std::string& footer, CommandText& command) {
  std::vector<std::vector<std::string>> blocks(1);
  for (const std::string& line : Split(footer, '\n')) {
    if (!line.empty())
      blocks.back().push_back(line);
    else if (!blocks.back().empty())
      blocks.emplace_back();
  }
  for (const std::vector<std::string>& block : blocks) {
    if (block.empty()) continue;
    if (block.front().ends_with(':') && block.size() > 1 && block[1].starts_with("  ")) {
      ListText list{.title = block.front().substr(0, block.front().size() - 1), .lines = {}};
      for (std::size_t i = 1; i < block.size(); ++i) list.lines.push_back(block[i].substr(2));
      command.lists.push_back(std::move(list));
      continue;
    }
    std::string text = fmt::format("{}", fmt::join(block, " "));
    constexpr std::string_view kExitCode = "Exit code ";
    if (!text.starts_with(kExitCode)) {
      command.paragraphs.push_back(std::move(text));
      continue;
    }
    int code = 0;
    const std::size_t colon = text.find(": ");
    std::from_chars(text.data() + kExitCode.size(), text.data() + std::min(colon, text.size()), code);
    command.exit_codes[code] = text.substr(colon + 2);
  }
}

CommandText DescribeCommand(const CLI::App& app) {
  CommandText text{.name = NameOf(app),
                   .purpose = app.get_description(),
                   .group = app.get_group(),
                   .needs_command = app.get_require_subcommand_min() > 0,
                   .options = {},
                   .paragraphs = {},
                   .lists = {},
                   .exit_codes = {},
                   .commands = {}};
  const std::vector<const CLI::Option*> options = app.get_options(std::function<bool(const CLI::Option*)>{});
  for (const CLI::Option* option : options)
    if (!option->get_group().empty()) text.options.push_back(DescribeOption(*option, options));
  ParseFooter(app.get_footer(), text);
  for (const CLI::App* sub : app.get_subcommands(std::function<bool(const CLI::App*)>{}))
    if (!sub->get_group().empty() && !sub->get_name().empty()) text.commands.push_back(DescribeCommand(*sub));
  return text;
}

CommandText DescribeCommands(std::span<const CLI::App* const> apps) {
  CommandText all = DescribeCommand(*apps.front());
  for (const CLI::App* app : apps.subspan(1)) {
    for (CommandText& command : DescribeCommand(*app).commands) {
      command.name = all.name + " " + command.word();
      for (CommandText& sub : command.commands) sub.name = command.name + " " + sub.word();
      const auto same = std::ranges::find(all.commands, command.name, &CommandText::name);
      if (same == all.commands.end())
        all.commands.push_back(std::move(command));
      else if (command.options.size() + command.commands.size() >
               same->options.size() + same->commands.size()) {
        command.group = same->group;
        *same = std::move(command);
      }
    }
  }
  return all;
}

std::string AcceptedText(const OptionText& option) {
  return option.words.empty() ? option.range : fmt::format("{}", fmt::join(option.words, ", "));
}

std::span<const std::pair<int, std::string_view>> CommonExitCodes() { return kCommonExitCodes; }

std::string LauncherFooter() {
  std::string text = "The launcher ./osteon adds:\n";
  for (const LauncherCommand& command : kLauncherCommands)
    text +=
        fmt::format("  {:<26}{}\n", fmt::format("{} {}", command.name, command.arguments), command.purpose);
  return text + "\n";
}

}  // namespace osteon::app
