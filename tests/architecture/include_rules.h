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
  std::vector<std::string> names;    ///< folders or libraries that the rule applies to
  std::vector<std::string> allowed;  ///< kFolder: what it may include; kLibrary: who may include it
  std::string reason;
};

/// One #include that the rules forbid.
struct Violation {
  std::string file;  ///< relative to the root
  int line = 0;      ///< from 1
  std::string text;  ///< what is wrong, and what is accepted
};

/// Reads the rules of include_rules.txt (its head describes the form).
/// @throws std::runtime_error with file, line and the accepted form if a line has another form.
std::vector<Rule> ReadRules(const std::filesystem::path& file);

/// Lists the forbidden includes of one source text.
/// @param path  the file's path relative to the root, with '/': determines the folder whose rule applies.
std::vector<Violation> CheckText(const std::vector<Rule>& rules, std::string_view path,
                                 std::string_view text);

/// Lists the C++ files below root's visible folders (except build/), relative to it, sorted.
std::vector<std::string> SourceFiles(const std::filesystem::path& root);

}  // namespace osteon::architecture
