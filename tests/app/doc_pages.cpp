#include "tests/app/doc_pages.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace osteon::app {
namespace {

// Whether a folder contains no pages, because it is hidden, a build, or the output of a run.
bool Skipped(const std::filesystem::path& folder) {
  const std::string name = folder.filename().string();
  return name.starts_with(".") || name == "build" || name.ends_with("out");
}

std::string Trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// The command "osteon …" at the beginning of a text, without the launcher's path and without a comment. Empty
// if the text does not begin with a command, or if it is output of osteon ("osteon run: …").
std::string CommandOf(std::string text) {
  text = Trimmed(text);
  for (const std::string place : {"./", "osteon/"})
    if (text.starts_with(place)) text.erase(0, place.size());
  if (!text.starts_with("osteon ")) return {};
  static const std::regex comment(R"((\s+#.*|\s{2,}\S.*)$)");
  text = Trimmed(std::regex_replace(text, comment, ""));
  static const std::regex output(R"(^osteon [a-z]+:.*)");
  return std::regex_match(text, output) ? std::string() : text;
}

// Appends the text's command if there is one and it names a subcommand.
void AddCommand(std::vector<DocCommand>& commands, std::size_t line, const std::string& text, bool own_line) {
  DocCommand command{.line = line, .text = CommandOf(text), .words = {}, .own_line = own_line};
  if (command.text.empty()) return;
  std::istringstream words(command.text.substr(7));
  for (std::string word; words >> word;) command.words.push_back(word);
  if (!command.words.empty() && std::islower(static_cast<unsigned char>(command.words[0][0])) != 0)
    commands.push_back(command);
}

}  // namespace

DocPage ReadPage(const std::filesystem::path& root, const std::string& path) {
  std::ifstream file(root / path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  DocPage page{.path = path, .lines = {}};
  bool fenced = false, after_text = false;
  std::string language;
  for (std::string text; std::getline(file, text);) {
    const std::string trimmed = Trimmed(text);
    if (trimmed.starts_with("```")) {
      fenced = !fenced;
      language = fenced ? trimmed.substr(3) : "";
      page.lines.push_back({.text = "", .code = true, .language = ""});
      after_text = false;
      continue;
    }
    // four spaces begin a code block, unless the line continues a paragraph
    const bool indented = !fenced && text.starts_with("    ") && !after_text;
    page.lines.push_back({.text = text, .code = fenced || indented, .language = language});
    after_text = !trimmed.empty() && !fenced && !indented;
  }
  return page;
}

std::vector<DocPage> DocPages(const std::filesystem::path& root) {
  std::vector<std::string> paths;
  std::filesystem::recursive_directory_iterator at(root), end;
  for (; at != end; ++at) {
    if (at->is_directory() && Skipped(at->path()))
      at.disable_recursion_pending();
    else if (at->path().extension() == ".md")
      paths.push_back(at->path().lexically_relative(root).generic_string());
  }
  std::ranges::sort(paths);
  std::vector<DocPage> pages;
  for (const std::string& path : paths) pages.push_back(ReadPage(root, path));
  return pages;
}

std::vector<DocLink> Links(const DocPage& page) {
  static const std::regex link(R"re((?:\]\(|src=")([^)"\s#]*)(#([^)\s]*))?[)"])re");
  std::vector<DocLink> links;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    if (page.lines[i].code) continue;
    const std::string& text = page.lines[i].text;
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
      const std::string file = (*at)[1];
      if (file.find("://") == std::string::npos && !file.starts_with("mailto:"))
        links.push_back({.line = i + 1, .file = file, .heading = (*at)[3]});
    }
  }
  return links;
}

std::set<std::string> Headings(const DocPage& page) {
  std::set<std::string> headings;
  for (const DocLine& line : page.lines) {
    if (line.code || !line.text.starts_with("#")) continue;
    std::string name;
    for (const char c : Trimmed(line.text.substr(line.text.find_first_not_of('#')))) {
      const auto byte = static_cast<unsigned char>(c);
      if (std::isalnum(byte) != 0 || c == '-' || c == '_' || byte >= 0x80)
        name += static_cast<char>(std::tolower(byte));
      else if (c == ' ')
        name += '-';
    }
    headings.insert(name);
  }
  return headings;
}

std::vector<DocCommand> Commands(const DocPage& page) {
  static const std::regex span(R"(`([^`]+)`)");
  std::vector<DocCommand> commands;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    const std::string& text = page.lines[i].text;
    if (page.lines[i].code) {
      AddCommand(commands, i + 1, text, true);
      continue;
    }
    for (std::sregex_iterator at(text.begin(), text.end(), span), end; at != end; ++at)
      AddCommand(commands, i + 1, (*at)[1], false);
  }
  return commands;
}

std::vector<std::string> PagesWithCommands(const std::filesystem::path& root) {
  std::vector<std::string> paths;
  for (const DocPage& page : DocPages(root)) {
    if (page.path != "README.md" && !page.path.starts_with("docs/")) continue;
    if (page.path == "docs/commands.md")
      continue;  // the command generates this page; its examples are those of --help
    const std::vector<DocCommand> commands = Commands(page);
    if (std::ranges::any_of(commands, &DocCommand::own_line)) paths.push_back(page.path);
  }
  return paths;
}

std::vector<DocDifference> Differences(const DocPage& page) {
  std::vector<DocDifference> differences;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    if (page.lines[i].language != "diff") continue;
    const std::string& text = page.lines[i].text;
    if (text.starts_with("--- a/")) {
      differences.push_back({.line = i + 1, .file = text.substr(6), .parts = {}});
      continue;
    }
    if (differences.empty() || text.starts_with("+++ ")) continue;
    if (text.starts_with("@@")) {
      differences.back().parts.emplace_back();
      continue;
    }
    if (differences.back().parts.empty()) continue;
    DocDifference::Part& part = differences.back().parts.back();
    const std::string rest = (text.empty() ? "" : text.substr(1)) + "\n";
    if (!text.starts_with("+")) part.before += rest;
    if (!text.starts_with("-")) part.after += rest;
  }
  return differences;
}

}  // namespace osteon::app
