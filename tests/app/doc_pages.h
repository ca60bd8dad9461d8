#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

// The project's Markdown pages, read as far as tests ask: links, headings, commands, differences.

namespace osteon::app {

struct DocLine {
  std::string text;
  bool code{false};      ///< in a fenced or indented block
  std::string language;  ///< of the fence
};

struct DocPage {
  std::string path;  ///< from the root
  std::vector<DocLine> lines;
};

/// @throws std::runtime_error where there is no such page.
[[nodiscard]] DocPage ReadPage(const std::filesystem::path& root, const std::string& path);
/// All of them but what a build or a run has left, sorted.
[[nodiscard]] std::vector<DocPage> DocPages(const std::filesystem::path& root);

struct DocLink {
  std::size_t line{0};  ///< from 1
  std::string file;     ///< empty: the same page
  std::string heading;  ///< empty: the whole page
};
/// Those into the tree; addresses of other machines are left out.
[[nodiscard]] std::vector<DocLink> Links(const DocPage& page);

/// As links name them: lower case, without marks, hyphens for spaces.
[[nodiscard]] std::set<std::string> Headings(const DocPage& page);

struct DocCommand {
  std::size_t line{0};
  std::string text;                ///< "osteon demo --virtual-time": without "./" and remark
  std::vector<std::string> words;  ///< after "osteon"
  bool own_line{false};            ///< a line of a block to be typed, not a mention in a sentence
};
/// What is shown as a command of osteon. What osteon itself prints ("osteon run: …") is none.
[[nodiscard]] std::vector<DocCommand> Commands(const DocPage& page);

/// Pages for users that have lines to be typed: the README and docs/.
[[nodiscard]] std::vector<std::string> PagesWithCommands(const std::filesystem::path& root);

/// Of one file: texts that stand there, and what takes their place.
struct DocDifference {
  struct Part {
    std::string before, after;
  };
  std::size_t line{0};
  std::string file;
  std::vector<Part> parts;
};
/// The page's blocks in `diff`.
[[nodiscard]] std::vector<DocDifference> Differences(const DocPage& page);

}  // namespace osteon::app
