#include "app/cli/help/manual.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/cli/help/help_text.h"
#include "base/text.h"

namespace osteon::app {
namespace {

constexpr std::size_t kPageWidth = 116;  // columns of a Markdown line

// Returns the commands that do something by themselves, in order: `bench frame`, but not `bench`, which only
// groups subcommands.
std::vector<const CommandText*> Leaves(const CommandText& command) {
  std::vector<const CommandText*> leaves;
  for (const CommandText& sub : command.commands) {
    if (sub.commands.empty()) {
      leaves.push_back(&sub);
      continue;
    }
    for (const CommandText* leaf : Leaves(sub)) leaves.push_back(leaf);
  }
  return leaves;
}

// --- roff ---

// Decodes the first character of a UTF-8 text and removes it from the text. @returns its code point
std::uint32_t NextCharacter(std::string_view& text) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i]));
  };
  std::uint32_t code = byte(0);  // the first byte's high bits tell the number of bytes
  std::size_t length = 1;
  if (code >= 0xF0u) {
    length = 4;
    code &= 0x07u;
  } else if (code >= 0xE0u) {
    length = 3;
    code &= 0x0Fu;
  } else if (code >= 0xC0u) {
    length = 2;
    code &= 0x1Fu;
  }
  length = std::min(length, text.size());
  for (std::size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3Fu);
  text.remove_prefix(length);
  return code;
}

// Returns a line of text as roff in which no character acts as a request or an escape, and a hyphen stays a
// hyphen.
std::string Roff(std::string_view text) {
  std::string out;
  if (text.starts_with('.') || text.starts_with('\'')) out = "\\&";
  while (!text.empty()) {
    const std::uint32_t code = NextCharacter(text);
    if (code == '\\')
      out += "\\e";
    else if (code == '-')
      out += "\\-";
    else if (code == '\'')
      out += "\\(aq";
    else if (code == '`')
      out += "\\(ga";
    else if (code == 0x2026u)
      out += "...";  // not every output device of troff has the ellipsis
    else if (code < 0x80u)
      out += static_cast<char>(code);
    else
      out += fmt::format("\\[u{:04X}]", code);
  }
  return out;
}

// Returns a command's options as roff, a tagged paragraph (.TP) for each.
std::string RoffOptions(const CommandText& command) {
  std::string text;
  for (const OptionText& option : command.options) {
    if (option.names.back() == "--help") continue;  // every command has this option: it is described once
    const std::string names = fmt::format("{}", fmt::join(option.names, ", "));
    text += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", Roff(names), Roff(OptionHead(option).substr(names.size())),
                        Roff(OptionBody(option)));
  }
  return text;
}

// Returns a command's paragraphs, exit codes and lists as roff.
std::string RoffTexts(const CommandText& command) {
  std::string text;
  for (const std::string& paragraph : command.paragraphs) text += ".PP\n" + Roff(paragraph) + "\n";
  for (const auto& [code, meaning] : command.exit_codes)
    text += fmt::format(".PP\nExit code {}: {}\n", code, Roff(meaning));
  for (const ListText& list : command.lists) {
    text += ".PP\n" + Roff(list.title) + ":\n.PP\n.RS 4\n.nf\n";
    for (const std::string& line : list.lines) text += Roff(line) + "\n";
    text += ".fi\n.RE\n";
  }
  return text;
}

// --- Markdown ---

// Returns the text of a table's cell; a bar is escaped, since it would end the cell.
std::string Cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

// Returns code in a table's cell. A bar is escaped in code as well, which GitHub and python-markdown accept.
std::string Code(const std::string& text) { return "`" + Cell(text) + "`"; }

// Returns a table of a command's options; empty if --help is the only one.
std::string MarkdownOptions(const CommandText& command) {
  std::string rows;
  for (const OptionText& option : command.options) {
    if (option.names.back() == "--help") continue;
    std::string help = option.help;
    if (!option.needs.empty()) help += fmt::format("; needs `{}`", fmt::join(option.needs, "`, `"));
    if (!option.excludes.empty()) help += fmt::format("; not with `{}`", fmt::join(option.excludes, "`, `"));
    const std::string accepted =
        option.words.empty() ? option.range : fmt::format("`{}`", fmt::join(option.words, "`, `"));
    std::string head = fmt::format("{}", fmt::join(option.names, ", "));
    if (!option.value.empty() && !option.is_argument) head += " " + option.value;
    if (option.is_argument && option.repeats) head += " …";
    rows += fmt::format("| {} | {} | {} | {} |\n", Code(head), Cell(help), Cell(accepted),
                        option.required                ? "required"
                        : option.default_value.empty() ? ""
                                                       : Code(option.default_value));
  }
  if (rows.empty()) return "";
  return "\n| option | what it does | accepted | default |\n|---|---|---|---|\n" + rows;
}

// Returns a command's paragraphs, exit codes and lists as Markdown.
std::string MarkdownTexts(const CommandText& command) {
  std::string text;
  for (const std::string& paragraph : command.paragraphs)
    text += "\n" + base::WrapText(paragraph, 0, kPageWidth) + "\n";
  for (const auto& [code, meaning] : command.exit_codes)
    text += "\n" + base::WrapText(fmt::format("Exit code {}: {}", code, meaning), 0, kPageWidth) + "\n";
  for (const ListText& list : command.lists) {
    text += "\n" + list.title + ":\n\n";
    for (const std::string& line : list.lines) text += "    " + line + "\n";
  }
  return text;
}

// Returns a heading's anchor, by GitHub's rule for the lower-case words of a command.
std::string Anchor(const std::string& heading) {
  std::string anchor = heading;
  std::ranges::replace(anchor, ' ', '-');
  return anchor;
}

// Returns a command with its options and subcommands as JSON.
nlohmann::ordered_json Json(const CommandText& command) {
  nlohmann::ordered_json options = nlohmann::json::array(), commands = nlohmann::json::array();
  nlohmann::ordered_json exit_codes = nlohmann::json::array();
  for (const OptionText& option : command.options)
    options.push_back({{"names", option.names},
                       {"argument", option.is_argument},
                       {"required", option.required},
                       {"repeats", option.repeats},
                       {"value", option.value},
                       {"words", option.words},
                       {"range", option.range},
                       {"default", option.default_value},
                       {"help", option.help},
                       {"group", option.group},
                       {"needs", option.needs},
                       {"excludes", option.excludes}});
  for (const auto& [code, meaning] : command.exit_codes)
    exit_codes.push_back({{"code", code}, {"meaning", meaning}});
  for (const CommandText& sub : command.commands) commands.push_back(Json(sub));
  return {{"name", command.name}, {"purpose", command.purpose}, {"synopsis", Synopsis(command)},
          {"options", options},   {"exit_codes", exit_codes},   {"commands", commands}};
}

}  // namespace

std::string ManPage(const CommandText& command, const std::string& version) {
  std::string page = fmt::format(
      ".\\\" Written by `osteon manual --man osteon.1` from the table that parses the command line.\n"
      ".TH OSTEON 1 \"\" \"Osteon {}\" \"User Commands\"\n"
      ".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
      version, Roff(command.name), Roff(command.purpose));
  page += ".B " + Roff(Synopsis(command)) + "\n";
  for (const CommandText* leaf : Leaves(command)) page += ".br\n.B " + Roff(Synopsis(*leaf)) + "\n";
  page +=
      ".SH DESCRIPTION\n"
      "Each subcommand prints its options and examples with \\fB\\-\\-help\\fR. Set\\-up output and errors "
      "go to stderr.\nCtrl\\-C ends in an orderly stop of the arm and complete files.\n";
  page += RoffTexts(command);
  page += ".SH OPTIONS\n" + RoffOptions(command);
  page += ".SH COMMANDS\n";
  for (const CommandText* leaf : Leaves(command)) {
    page += fmt::format(".SS \"{}\"\n{}\n", Roff(leaf->name), Roff(base::ToSentence(leaf->purpose)));
    page += RoffOptions(*leaf) + RoffTexts(*leaf);
  }
  page += ".SH \"EXIT STATUS\"\n";
  for (const auto& [code, meaning] : CommonExitCodes())
    page += fmt::format(".TP\n.B {}\n{}\n", code, Roff(meaning));
  page +=
      ".SH ENVIRONMENT\n.TP\n.B OSTEON_ROOT\nThe project\\(aqs folder; cells, robots, tools and scenes are "
      "found by name in its config/. The launcher sets it.\n"
      ".TP\n.B OSTEON_SOCKET_FOLDER\nFolder in which a running cell listens for status, pause, stop and the "
      "like, and in which these commands look, alone. Its group may ask, where it may enter the folder. Set "
      "by the service osteon@.\n"
      ".TP\n.B COLUMNS\nWidth of the text that \\-\\-help prints.\n";
  return page;
}

std::string CommandsPage(const CommandText& command) {
  std::string page =
      "# The command line\n\n"
      "Which subcommands are there, what do they take, and how do they end? This page is written by\n"
      "`osteon manual --markdown docs/commands.md` from the table that parses the command line; `--help` "
      "prints the\n"
      "same. `osteon manual` prints a manual page (`osteon manual | man -l -` shows it).\n\n"
      "A name under `cells/`, `tools/`, `scenes/`, `scenarios/` or `robots/` is accepted wherever a file of "
      "that kind\n"
      "is. `--help` is accepted everywhere. `--json FILE` writes one object with `\"schema\": "
      "\"osteon.<subcommand>/1\"`;\nits keys are contracts. Errors go to stderr: what was found, what is "
      "accepted.\n";
  page += "\n## All subcommands\n\n| subcommand | what it does |\n|---|---|\n";
  for (const CommandText* leaf : Leaves(command))
    page += fmt::format("| [{}](#{}) | {} |\n", leaf->name, Anchor(leaf->name), Cell(leaf->purpose));
  for (const LauncherCommand& launcher : kLauncherCommands)
    page += fmt::format("| `./osteon {}{}{}` | {} |\n", launcher.name, launcher.arguments.empty() ? "" : " ",
                        launcher.arguments, launcher.purpose);
  page += "\n## Options of all subcommands\n\nThey stand before the subcommand.\n" + MarkdownOptions(command);
  page += "\n## Exit codes\n\n| code | meaning |\n|---|---|\n";
  for (const auto& [code, meaning] : CommonExitCodes()) page += fmt::format("| {} | {} |\n", code, meaning);
  page +=
      "\n## Completion in the shell\n\n"
      "The shell completes subcommands, options, their words, files, and the names of cells, tools, scenes,\n"
      "scenarios and robots, once it has read the script that `osteon completion` prints. In the project's "
      "folder:\n\n"
      "    source <(./osteon completion bash)            # bash\n"
      "    source <(./osteon completion zsh)             # zsh\n"
      "    ./osteon completion fish | source             # fish\n\n"
      "To have it in every shell, keep the script in a file; the shell then starts without a build:\n\n"
      "    mkdir -p ~/.local/share/bash-completion/completions\n"
      "    ./osteon completion bash > ~/.local/share/bash-completion/completions/osteon\n";
  for (const CommandText* leaf : Leaves(command)) {
    page += fmt::format("\n## {}\n\n{}\n\n    {}\n", leaf->name,
                        base::WrapText(base::ToSentence(leaf->purpose), 0, kPageWidth), Synopsis(*leaf));
    page += MarkdownOptions(*leaf) + MarkdownTexts(*leaf);
  }
  return page;
}

std::string ManualJson(const CommandText& command) {
  nlohmann::ordered_json json{{"schema", "osteon.manual/1"}};
  json.update(Json(command));
  return json.dump(2) + "\n";
}

}  // namespace osteon::app
