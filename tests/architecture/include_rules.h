#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace osteon::architecture {

/// One line of include_rules.txt.
struct Rule {
  enum class Kind { kFolder, kLibrary };
  Kind kind = Kind::kFolder;
  std::vector<std::string> names;    ///< what the rule is about
  std::vector<std::string> allowed;  ///< kFolder: what it may include; kLibrary: who may include it
  std::string reason;
};

/// One #include that the rules forbid.
struct Violation {
  std::string file;  ///< relative to the root
  int line = 0;      ///< from 1
  std::string text;  ///< what is wrong, and what would be accepted
};

/// The rules of include_rules.txt (its head describes the form).
/// @throws std::runtime_error naming file, line and what is accepted, where a line is not of that form.
std::vector<Rule> ReadRules(const std::filesystem::path& file);

/// The includes of one source text that the rules forbid.
/// @param path  the file's path relative to the root, with '/': it says which folder's rule holds.
std::vector<Violation> CheckText(const std::vector<Rule>& rules, std::string_view path,
                                 std::string_view text);

/// C++ files below root's visible folders (build/ left out), relative to it, sorted.
std::vector<std::string> SourceFiles(const std::filesystem::path& root);

}  // namespace osteon::architecture
