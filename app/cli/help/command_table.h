#pragma once

#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

// The command line as data, read from the tree of CLI::App that parses it. Help, manual and completion are
// made from this data, so that they cannot differ from the parser.
//
// CLI11 has no field for some of these data. The tree keeps them in other fields:
// - Option::type_name: the value's kind (FILE, FOLDER, CELL, TOOL, SCENE, SCENARIO, ROBOT) or form (X,Y,Z).
// - Validator description: the accepted values, "1 … 100", or "{a,b}" for one of several words (usage.h).
// - App::footer: paragraphs, lists and exit codes, separated by blank lines (ParseFooter).

namespace osteon::app {

/// An option or an argument of a command.
struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--out"; of an argument only its name, "cell"
  bool is_argument{false};
  bool required{false};
  bool repeats{false};              ///< takes several values, or may occur several times on the command line
  std::string value;                ///< kind of the value: "FILE", "NUMBER"; empty: a flag
  std::vector<std::string> words;   ///< the accepted words; empty: no list of words
  std::string range;                ///< the accepted numbers, "1 … 100"; may be empty
  std::string help, default_value;  ///< default_value: empty if there is none
  std::string group;                ///< heading of the help under which the option is listed
  std::vector<std::string> needs, excludes;
};

/// A list at the end of a command's help.
struct ListText {
  std::string title;  ///< "Examples"
  std::vector<std::string> lines;
};

/// A command with its options, its texts and its subcommands.
struct CommandText {
  std::string name;           ///< as it is typed: "osteon bench frame"
  std::string purpose;        ///< one line
  std::string group;          ///< heading under which the help of the parent command lists this command
  bool needs_command{false};  ///< the name alone is no complete command: one of the subcommands must follow
  std::vector<OptionText> options;  ///< in the order of their definition
  std::vector<std::string> paragraphs;
  std::vector<ListText> lists;  ///< the last one: examples
  std::map<int, std::string> exit_codes;
  std::vector<CommandText> commands;

  /// The last word of the name: "frame".
  [[nodiscard]] std::string word() const { return name.substr(name.rfind(' ') + 1); }
};

/// Describes a command and its subcommands. Options and subcommands without a group are hidden and left out.
[[nodiscard]] CommandText DescribeCommand(const CLI::App& app);

/// Describes several executables as one command: name, options and texts of the first, subcommands of all. If
/// two of them have a subcommand of the same name, the one with more options is described: the executable
/// with fewer options only lists the subcommand in its help.
[[nodiscard]] CommandText DescribeCommands(std::span<const CLI::App* const> apps);

/// Splits a footer into its parts. Blocks are separated by blank lines. A block is a list if its first line
/// ends with ':' and its other lines are indented. A block "Exit code N: meaning" describes an exit code. Any
/// other block is a paragraph; its line breaks are ignored.
void ParseFooter(const std::string& footer, CommandText& command);

/// The accepted values as text: the words, or the range; empty if everything is accepted.
[[nodiscard]] std::string AcceptedText(const OptionText& option);

/// Exit codes that every subcommand has.
[[nodiscard]] std::span<const std::pair<int, std::string_view>> CommonExitCodes();

/// A command of the launcher ./osteon, which the built program does not know.
struct LauncherCommand {
  std::string_view name, arguments, purpose;
};
inline constexpr std::array kLauncherCommands = std::to_array<LauncherCommand>({
    {"test", "[ctest arguments]", "builds and runs every test"},
    {"docs", "", "builds the documents as a site"},
    {"clean", "", "removes what was built"},
});

/// The list of the launcher's commands, as a block of a footer.
[[nodiscard]] std::string LauncherFooter();

}  // namespace osteon::app
