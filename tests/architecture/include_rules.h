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
  std::vector<std::string> names;  ///< the folders or libraries to which the rule applies
  /// kFolder: names that the folder may include; kLibrary: folders that may include the library
  std::vector<std::string> allowed;
  std::string reason;
};

/// One #include that the rules forbid.
struct Violation {
  std::string file;  ///< relative to the root
  int line = 0;      ///< from 1
  std::string text;  ///< the error, and the accepted includes
};

/// Reads the rules of include_rules.txt (the comment at its beginning describes the form).
/// @throws std::runtime_error with file, line and the accepted form if a line has another form.
std::vector<Rule> ReadRules(const std::filesystem::path& file);

/// Lists the forbidden includes of one source text.
/// @param path  path of the file relative to the root, with '/'; the folder in it determines which rule
/// applies
std::vector<Violation> CheckText(const std::vector<Rule>& rules, std::string_view path,
                                 std::string_view text);

/// Lists the C++ files below root's visible folders (except build/), relative to it, sorted.
std::vector<std::string> SourceFiles(const std::filesystem::path& root);

}  // namespace osteon::architecture
