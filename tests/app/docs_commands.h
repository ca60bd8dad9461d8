#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// How tests run the commands of the pages: unchanged if a command is fast, with smaller arguments if it is
// not, and in a test of its own if it needs several processes or minutes.

namespace osteon::app {

/// How a test runs a command that a page shows.
struct DocRun {
  std::vector<std::string> arguments;  ///< after "osteon"
  std::vector<std::string> leaves;     ///< files that must exist afterwards
  /// "Suite.Name" of the test that runs it instead.
  std::string elsewhere;
  std::function<void(const std::filesystem::path&)> before{};  ///< prepares the folder
};

/// Returns how to run a command; nothing if the command is not known here.
[[nodiscard]] std::optional<DocRun> HowToRun(const std::string& command);
/// Lists all known commands.
[[nodiscard]] std::vector<std::string> KnownCommands();

/// Puts config/ and meshes, under the names that the pages use, into the folder.
void PutInputs(const std::filesystem::path& root, const std::filesystem::path& folder);

/// Whether a source under tests/ contains the test.
[[nodiscard]] bool IsTest(const std::filesystem::path& root, const std::string& suite_and_name);

}  // namespace osteon::app
