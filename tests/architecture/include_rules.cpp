#include "tests/architecture/include_rules.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace osteon::architecture {
namespace {

std::vector<std::string> Words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Whether the path equals `name`, lies below the directory `name`, or has the ending of a `name` like `*.x`.
bool Matches(std::string_view name, std::string_view path) {
  if (name.starts_with('*')) return path.ends_with(name.substr(1));
  return path == name || (path.starts_with(name) && path[name.size()] == '/');
}

/// Whether the path matches one of the names; "all" matches every path.
bool MatchesAny(const std::vector<std::string>& names, std::string_view path) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return name == "all" || Matches(name, path); });
}

struct Match {
  const Rule* rule = nullptr;
  std::string name;  // the longest name of the rule that the path matches
};

/// The rule of this kind whose name matches the path with the most characters; null if no rule matches.
Match FindRule(const std::vector<Rule>& rules, Rule::Kind kind, std::string_view path) {
  Match best;
  for (const Rule& rule : rules) {
    if (rule.kind != kind) continue;
    for (const std::string& name : rule.names) {
      if (Matches(name, path) && name.size() > best.name.size()) best = {&rule, name};
    }
  }
  return best;
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text.empty() ? "nothing" : text;
}

/// Whether an include names a header of the C++ standard library, which has neither directory nor ending.
bool IsStandardHeader(std::string_view include) {
  return include.find_first_of("/.") == std::string_view::npos;
}

/// The error text for an include in a file of folder `includer`; empty if the include is allowed.
std::string Complaint(const std::vector<Rule>& rules, const Match& includer, std::string_view path,
                      const std::string& include) {
  if (include.find("..") != std::string::npos) {
    return "\"" + include + "\" steps out of its folder; write the path from the root";
  }
  if (const Match included = FindRule(rules, Rule::Kind::kFolder, include); included.rule) {
    if (included.name == includer.name || MatchesAny(includer.rule->allowed, include)) return {};
    return includer.name + "/ may not include " + include +
           "; it may include: " + Join(includer.rule->allowed) + " (" + includer.rule->reason + ")";
  }
  // Tests may include any library, because they use libraries as oracles.
  if (IsStandardHeader(include) || includer.name == "tests") return {};
  const Match library = FindRule(rules, Rule::Kind::kLibrary, include);
  if (!library.rule) {
    return "<" + include +
           "> belongs to no folder and to no library of tests/architecture/include_rules.txt; " +
           "name it there with its reason";
  }
  if (MatchesAny(library.rule->allowed, path)) return {};
  return "<" + include + "> is for: " + Join(library.rule->allowed) + " (" + library.rule->reason + ")";
}

}  // namespace

std::vector<Rule> ReadRules(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  static const std::regex form(R"(^\s*(folder|library)\s+([^:|]+):([^|]*)\|\s*(\S.*)$)");
  std::vector<Rule> rules;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (const auto first = line.find_first_not_of(" \t"); first == std::string::npos || line[first] == '#')
      continue;
    std::smatch match;
    if (!std::regex_match(line, match, form)) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": found '" + line +
                               "', accepted 'folder NAME : … | why' or 'library NAME … : … | why'");
    }
    rules.push_back({match[1] == "folder" ? Rule::Kind::kFolder : Rule::Kind::kLibrary, Words(match[2]),
                     Words(match[3]), match[4]});
  }
  return rules;
}

std::vector<Violation> CheckText(const std::vector<Rule>& rules, std::string_view path,
                                 std::string_view text) {
  const Match includer = FindRule(rules, Rule::Kind::kFolder, path);
  if (!includer.rule) {
    return {
        {std::string(path), 1, "lies in a folder that tests/architecture/include_rules.txt does not name"}};
  }
  static const std::regex form(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*$)");
  std::vector<Violation> violations;
  std::istringstream stream{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::smatch match;
    if (line.find("include") == std::string::npos || !std::regex_match(line, match, form)) continue;
    if (std::string complaint = Complaint(rules, includer, path, match[1]); !complaint.empty()) {
      violations.push_back({std::string(path), number, std::move(complaint)});
    }
  }
  return violations;
}

std::vector<std::string> SourceFiles(const std::filesystem::path& root) {
  namespace fs = std::filesystem;
  std::vector<std::string> files;
  for (const fs::directory_entry& folder : fs::directory_iterator(root)) {
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || name.starts_with('.') || name == "build") continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      const std::string ending = entry.path().extension().string();
      const std::string path = entry.path().lexically_relative(root).generic_string();
      if (path.find("/third_party/") != std::string::npos) continue;  // third-party sources are not checked
      if (!entry.is_regular_file() ||
          (ending != ".h" && ending != ".hpp" && ending != ".cpp" && ending != ".cc")) {
        continue;
      }
      files.push_back(path);
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace osteon::architecture
