#include "app/cli/help/help_text.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"

namespace osteon::app {
namespace {

// columns of the help's lines
constexpr std::size_t kMinWidth = 50, kDefaultWidth = 80, kMaxWidth = 120;
constexpr std::size_t kTextColumn = 26;      // column at which explanations begin
constexpr std::size_t kMaxWordsInHead = 22;  // columns of a word list; a longer one is in the explanation

// Whether an option's accepted words are short enough to be shown beside its name, as in "--mode a|b".
bool ShowsWordsInHead(const OptionText& option) {
  return !option.words.empty() && fmt::format("{}", fmt::join(option.words, "|")).size() <= kMaxWordsInHead;
}

// Returns a row of two columns; the second begins on the next line if the first is too long.
std::string Row(const std::string& head, const std::string& body, std::size_t width) {
  std::string text = "  " + head;
  const std::size_t used = base::ColumnsOf(text);
  if (body.empty()) return text + "\n";
  text +=
      used + 2 > kTextColumn ? "\n" + std::string(kTextColumn, ' ') : std::string(kTextColumn - used, ' ');
  return text + base::WrapText(body, kTextColumn, width) + "\n";
}

// Returns an example. A long example is continued on further lines, in the form that a shell accepts.
std::string ExampleLine(const std::string& line, std::size_t width) {
  std::string text;
  std::string rest = "  " + line;
  while (base::ColumnsOf(rest) > width) {
    const std::size_t at = rest.rfind(" --", width - 3);  // before an option, with room for " \"
    if (at == std::string::npos || at < 12) break;
    text += rest.substr(0, at) + " \\\n";
    rest = "     " + rest.substr(at);
  }
  return text + rest + "\n";
}

// Returns the headings of the options, in the order in which they first appear.
std::vector<std::string> GroupsOf(const std::vector<OptionText>& options) {
  std::vector<std::string> groups;
  for (const OptionText& option : options)
    if (!option.is_argument && std::ranges::find(groups, option.group) == groups.end())
      groups.push_back(option.group);
  return groups;
}

}  // namespace

std::string OptionHead(const OptionText& option) {
  std::string head = fmt::format("{}", fmt::join(option.names, ", "));
  if (option.is_argument) return head + (option.repeats ? " …" : "");
  if (!option.value.empty())
    head += ShowsWordsInHead(option) ? fmt::format(" {}", fmt::join(option.words, "|")) : " " + option.value;
  return head;
}

std::string OptionBody(const OptionText& option) {
  std::vector<std::string> notes;
  const std::string accepted = ShowsWordsInHead(option) && !option.is_argument ? "" : AcceptedText(option);
  if (!accepted.empty()) notes.push_back(accepted);
  if (!option.default_value.empty()) notes.push_back("default " + option.default_value);
  if (option.required && !option.is_argument) notes.emplace_back("required");
  if (!option.needs.empty()) notes.push_back(fmt::format("needs {}", fmt::join(option.needs, ", ")));
  if (!option.excludes.empty()) notes.push_back(fmt::format("not with {}", fmt::join(option.excludes, ", ")));
  if (notes.empty()) return option.help;
  return fmt::format("{} [{}]", option.help, fmt::join(notes, "; "));
}

std::string Synopsis(const CommandText& command) {
  std::string line = command.name;
  bool has_options = false;
  for (const OptionText& option : command.options) {
    if (option.is_argument) continue;
    if (option.required)
      line += " " + (option.names.back() + " " + option.value);
    else
      has_options = true;
  }
  if (has_options) line += " [options]";
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    const std::string name = option.names.front() + (option.repeats ? "…" : "");
    line += option.required ? " " + name : " [" + name + "]";
  }
  if (!command.commands.empty()) line += command.needs_command ? " subcommand" : " [subcommand]";
  return line;
}

std::string HelpText(const CommandText& command, std::size_t width) {
  width = std::max(width, kMinWidth);
  std::string text = base::WrapText(command.name + ": " + command.purpose, 0, width) + "\n\n";
  text += "Usage: " + base::WrapText(Synopsis(command), 7, width) + "\n";  // 7: columns of "Usage: "
  std::string arguments;
  for (const OptionText& option : command.options)
    if (option.is_argument) arguments += Row(OptionHead(option), OptionBody(option), width);
  if (!arguments.empty()) text += "\nArguments:\n" + arguments;
  for (const std::string& group : GroupsOf(command.options)) {
    text += "\n" + group + ":\n";
    for (const OptionText& option : command.options)
      if (!option.is_argument && option.group == group)
        text += Row(OptionHead(option), OptionBody(option), width);
  }
  std::vector<std::string> groups;
  for (const CommandText& sub : command.commands)
    if (std::ranges::find(groups, sub.group) == groups.end()) groups.push_back(sub.group);
  for (const std::string& group : groups) {
    text += "\n" + group + ":\n";
    for (const CommandText& sub : command.commands)
      if (sub.group == group) text += Row(sub.word(), sub.purpose, width);
  }
  for (const std::string& paragraph : command.paragraphs)
    text += "\n" + base::WrapText(paragraph, 0, width) + "\n";
  for (const auto& [code, meaning] : command.exit_codes)
    text += "\n" + base::WrapText(fmt::format("Exit code {}: {}", code, meaning), 0, width) + "\n";
  for (const ListText& list : command.lists) {
    text += "\n" + list.title + ":\n";
    for (const std::string& line : list.lines) text += ExampleLine(line, width);
  }
  return text;
}

std::size_t HelpWidth() {
  return std::clamp(base::TerminalColumns().value_or(kDefaultWidth), kMinWidth, kMaxWidth);
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const {
  return HelpText(DescribeCommand(*app), HelpWidth());
}

}  // namespace osteon::app
