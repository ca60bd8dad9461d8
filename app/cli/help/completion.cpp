#include "app/cli/help/completion.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace osteon::app {
namespace {

// Returns a text in single quotes, so that a shell does not interpret it.
std::string Quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string Joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

// Source of a value's completions: the names of the YAML files in a folder below config/, any files, any
// folders, or nothing.
struct ValueSource {
  std::string names;    // folder below config/, e.g. "cells"
  bool files{false};    // any file
  bool folders{false};  // any folder, no files
};

// Returns the source of completions for an option, by the kind of its value.
ValueSource SourceOf(const OptionText& option) {
  if (option.value == "FILE" || option.value.starts_with("FILE ")) return {.names = "", .files = true};
  if (option.value == "FOLDER") return {.names = "", .folders = true};
  for (const char* kind : {"CELL", "TOOL", "SCENE", "SCENARIO", "ROBOT"})
    if (option.value == kind) {
      std::string folder = kind;
      std::ranges::transform(folder, folder.begin(),
                             [](unsigned char c) { return static_cast<char>(c + 32); });  // A-Z to a-z
      return {.names = folder + "s", .files = true};
    }
  return {};
}

std::vector<std::string> OptionNames(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    if (!option.is_argument) names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

std::vector<std::string> CommandWords(const CommandText& command) {
  std::vector<std::string> words;
  for (const CommandText& sub : command.commands) words.push_back(sub.word());
  return words;
}

// Returns the words that may follow `osteon`: its subcommands, and the launcher's commands.
std::vector<std::string> TopWords(const CommandText& command) {
  std::vector<std::string> words = CommandWords(command);
  for (const LauncherCommand& launcher : kLauncherCommands) words.emplace_back(launcher.name);
  return words;
}

// Calls `each` with a command and with every command below it.
template <class Each>
void ForEachCommand(const CommandText& command, Each&& each) {
  each(command);
  for (const CommandText& sub : command.commands) ForEachCommand(sub, each);
}

// --- bash ---

// Returns the script's assignments that say how an option's value is completed.
std::string BashValue(const OptionText& option) {
  const ValueSource source = SourceOf(option);
  if (!option.words.empty()) return "choices=" + Quoted(Joined(option.words));
  if (!source.names.empty()) return "names=" + source.names + " files=f";
  if (source.files) return "files=f";
  if (source.folders) return "files=d";
  return ":";
}

// Returns the branches of _osteon_table (kBashHead), one for each command.
std::string BashTable(const CommandText& top) {
  std::string text;
  ForEachCommand(top, [&](const CommandText& command) {
    const bool is_top = &command == &top;
    text += fmt::format("    {})\n      subcommands={}\n      flags={}\n", Quoted(command.name),
                        Quoted(Joined(is_top ? TopWords(command) : CommandWords(command))),
                        Quoted(Joined(OptionNames(command))));
    text += "      case $2 in\n";
    // a word that no option precedes is completed as the first argument: only that one is listed
    bool has_argument = false;
    for (const OptionText& option : command.options) {
      if (option.value.empty() || (option.is_argument && std::exchange(has_argument, true))) continue;
      if (option.is_argument)
        text += fmt::format("        '') {} ;;\n", BashValue(option));
      else
        text += fmt::format("        {}) takes_value=1 {} ;;\n", fmt::join(option.names, " | "),
                            BashValue(option));
    }
    text += "      esac ;;\n";
  });
  return text;
}

// The script before and after the branches of BashTable.
constexpr const char* kBashHead =
    R"sh(# Completion of osteon for bash, written by `osteon completion bash`: source <(./osteon completion bash)

# _osteon_table COMMAND OPTION: sets subcommands and flags of the command, and how the option's value, or without an
# option the command's argument, is completed: choices, names of a folder below config/, files (f) or folders (d).
_osteon_table() {
  subcommands='' flags='' choices='' names='' files='' takes_value=''
  case $1 in
)sh";

constexpr const char* kBashTail = R"sh(  esac
}

# Prints the names of the YAML files in a folder below config/: that of --config-root, of the launcher's folder, of the
# installation, or of OSTEON_ROOT.
_osteon_names() {
  local program folder=$config_root file
  if [[ -z $folder ]]; then
    program=${COMP_WORDS[0]/#\~/$HOME}
    [[ $program == */* ]] || program=$(command -v "$program")
    program=$(readlink -f "$program" 2>/dev/null)
    folder=${program%/*}/config
    [[ -d $folder ]] || folder=${program%/*}/../share/osteon/config
    [[ -d $folder ]] || folder=${OSTEON_ROOT:-.}/config
  fi
  for file in "$folder/$1"/*.yaml; do
    [[ -e $file ]] || continue
    file=${file##*/}
    printf '%s\n' "${file%.yaml}"
  done
}

_osteon() {
  local current=${COMP_WORDS[COMP_CWORD]} previous='' command=osteon config_root='' i word
  local subcommands flags choices names files takes_value
  # --option=value is three words
  if [[ $current == '=' ]]; then
    current='' previous=${COMP_WORDS[COMP_CWORD - 1]}
  elif ((COMP_CWORD > 2)) && [[ ${COMP_WORDS[COMP_CWORD - 1]} == '=' ]]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  elif ((COMP_CWORD > 1)); then
    previous=${COMP_WORDS[COMP_CWORD - 1]}
  fi
  # the subcommand: a word that is not an option's value
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    _osteon_table "$command" "$word"
    if [[ $word == -* ]]; then
      if [[ -n $takes_value ]]; then
        i=$((i + 1))
        if [[ ${COMP_WORDS[i]} == '=' ]]; then i=$((i + 1)); fi
        if [[ $word == --config-root ]] && ((i < COMP_CWORD)); then config_root=${COMP_WORDS[i]}; fi
      fi
    elif [[ " $subcommands " == *" $word "* ]]; then
      command+=" $word"
    fi
  done
  COMPREPLY=()
  [[ $previous == -* ]] || previous=''
  _osteon_table "$command" "$previous"
  if [[ -z $takes_value ]]; then
    _osteon_table "$command" ''
    if [[ $current == -* ]]; then
      choices=$flags names='' files=''
    else
      choices="$choices $subcommands"
      # nothing else can stand here
      if [[ -z ${choices// /}$names$files ]]; then choices=$flags; fi
    fi
  fi
  if [[ -n $names ]]; then choices="$choices $(_osteon_names "$names")"; fi
  while IFS= read -r word; do
    COMPREPLY+=("$word")
  done < <(
    compgen -W "$choices" -- "$current"
    if [[ -n $files ]]; then compgen "-$files" -- "$current"; fi
  )
  if [[ -n $files ]]; then compopt -o filenames 2>/dev/null || true; fi
}
complete -F _osteon osteon
)sh";

// --- fish and zsh ---

// Returns fish's condition that every word of the command's name ("bench frame") was typed; empty for
// `osteon` itself.
std::string FishCondition(const CommandText& command) {
  std::string condition;
  const std::string words = command.name.substr(std::min(command.name.find(' '), command.name.size()));
  std::size_t at = 0;
  while (at < words.size()) {
    const std::size_t end = std::min(words.find(' ', at + 1), words.size());
    condition +=
        (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from" + words.substr(at, end - at));
    at = end;
  }
  return condition;
}

// Returns fish's line `complete` for an option, or for an argument's values.
std::string FishOption(const CommandText& command, const OptionText& option) {
  std::string line = "complete -c osteon";
  if (const std::string condition = FishCondition(command); !condition.empty())
    line += " -n " + Quoted(condition);
  for (const std::string& name : option.names) {
    if (option.is_argument) continue;
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  const ValueSource source = SourceOf(option);
  if (!option.words.empty())
    line += " -x -a " + Quoted(Joined(option.words));
  else if (!source.names.empty())
    line += " -r -F -a " + Quoted("(__osteon_names " + source.names + ")");
  else if (source.folders)
    line += " -x -a '(__fish_complete_directories)'";
  else if (source.files)
    line += " -r -F";
  else if (!option.value.empty())
    line += " -x";
  if (!option.is_argument) line += " -d " + Quoted(option.help);
  return line + "\n";
}

}  // namespace

std::string BashCompletion(const CommandText& command) { return kBashHead + BashTable(command) + kBashTail; }

std::string ZshCompletion(const CommandText& command) {
  std::string text = BashCompletion(command);
  const std::string of_bash = "# Completion of osteon for bash, written by `osteon completion bash`";
  text.replace(0, of_bash.size(),
               "#compdef osteon\n# Completion of osteon for zsh, written by `osteon completion zsh`");
  text.insert(text.rfind("complete -F"),
              "(($+functions[compdef])) || { autoload -U compinit && compinit; }\nautoload -U +X "
              "bashcompinit && bashcompinit\n");
  // zsh may load the script from its folder of completions at the first request. The script then runs as the
  // function _osteon and must answer this request itself.
  text += "[[ ${funcstack[1]-} != _osteon ]] || _bash_complete -F _osteon\n";
  return text;
}

std::string FishCompletion(const CommandText& command) {
  std::string text =
      "# Completion of osteon for fish, written by `osteon completion fish`: ./osteon completion fish | "
      "source\n\n"
      "function __osteon_names --description 'names of the YAML files in a folder below config/'\n"
      "  set -l program (command -s (commandline -opc)[1])\n"
      "  set -l folder (dirname (readlink -f $program))/config\n"
      "  test -d $folder; or set folder (dirname (readlink -f $program))/../share/osteon/config\n"
      "  test -d $folder; or set folder $OSTEON_ROOT/config\n"
      "  for file in $folder/$argv[1]/*.yaml\n    basename $file .yaml\n  end\nend\n\n"
      "complete -c osteon -f\n";
  ForEachCommand(command, [&](const CommandText& each) {
    std::string condition = FishCondition(each);
    if (!each.commands.empty()) {
      const std::string none_yet = "not __fish_seen_subcommand_from " +
                                   Joined(&each == &command ? TopWords(each) : CommandWords(each));
      condition = condition.empty() ? none_yet : condition + "; and " + none_yet;
    }
    for (const CommandText& sub : each.commands)
      text += fmt::format("complete -c osteon -n {} -a {} -d {}\n", Quoted(condition), sub.word(),
                          Quoted(sub.purpose));
    if (&each == &command)
      for (const LauncherCommand& launcher : kLauncherCommands)
        text += fmt::format("complete -c osteon -n {} -a {} -d {}\n", Quoted(condition), launcher.name,
                            Quoted(std::string(launcher.purpose)));
    for (const OptionText& option : each.options) text += FishOption(each, option);
  });
  return text;
}

}  // namespace osteon::app
