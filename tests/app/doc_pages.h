#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

// Reads what tests need from the project's Markdown pages: links, headings, commands, and blocks marked
// `diff`.

namespace osteon::app {

/// One line of a page.
struct DocLine {
  std::string text;
  bool code{false};      ///< whether the line is in a fenced or indented block
  std::string language;  ///< language of the fenced block
};

/// A Markdown page, as lines.
struct DocPage {
  std::string path;  ///< relative to the root
  std::vector<DocLine> lines;
};

/// @throws std::runtime_error if there is no such page.
[[nodiscard]] DocPage ReadPage(const std::filesystem::path& root, const std::string& path);
/// Reads all pages except those made by a build or a run, sorted.
[[nodiscard]] std::vector<DocPage> DocPages(const std::filesystem::path& root);

/// A link in a page to a file or a heading of this tree.
struct DocLink {
  std::size_t line{0};  ///< from 1
  std::string file;     ///< empty: the same page
  std::string heading;  ///< empty: the whole page
};
/// Lists the links into the tree; addresses of other machines are left out.
[[nodiscard]] std::vector<DocLink> Links(const DocPage& page);

/// The headings' anchors as links name them: lower case, without punctuation, hyphens for spaces.
[[nodiscard]] std::set<std::string> Headings(const DocPage& page);

/// A command of osteon on a page.
struct DocCommand {
  std::size_t line{0};
  std::string text;                ///< "osteon demo --virtual-time": without "./" and comment
  std::vector<std::string> words;  ///< after "osteon"
  bool own_line{false};            ///< true: a line for the user to type; false: a mention in a sentence
};
/// Lists the commands of osteon on a page. Output of osteon ("osteon run: …") is not a command.
[[nodiscard]] std::vector<DocCommand> Commands(const DocPage& page);

/// The pages that contain lines for the user to type: the README and docs/.
[[nodiscard]] std::vector<std::string> PagesWithCommands(const std::filesystem::path& root);

/// A block marked `diff`: parts of a file's text, and the text that replaces each part.
struct DocDifference {
  struct Part {
    std::string before, after;
  };
  std::size_t line{0};
  std::string file;
  std::vector<Part> parts;
};
/// Lists the page's blocks marked `diff`.
[[nodiscard]] std::vector<DocDifference> Differences(const DocPage& page);

}  // namespace osteon::app
