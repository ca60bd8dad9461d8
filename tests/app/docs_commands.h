#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// How tests run the commands of the pages: a fast command unchanged, a slow one with arguments that shorten
// it, and a command that needs several processes or minutes in a test of its own.

namespace osteon::app {

/// How a test runs one command of a page.
struct DocRun {
  std::vector<std::string> arguments;  ///< after "osteon"
  std::vector<std::string> leaves;     ///< files that must exist after the run
  /// "Suite.Name" of another test that runs the command; empty: the command is run as described here.
  std::string elsewhere;
  std::function<void(const std::filesystem::path&)> before{};  ///< prepares the folder for the run
};

/// Returns how to run a command; nothing if the command is not listed here.
[[nodiscard]] std::optional<DocRun> HowToRun(const std::string& command);
/// Lists all commands that HowToRun knows.
[[nodiscard]] std::vector<std::string> KnownCommands();

/// Copies config/ and meshes into the folder, under the names that the pages use.
void PutInputs(const std::filesystem::path& root, const std::filesystem::path& folder);

/// Whether a source file under tests/ contains the test with this name.
[[nodiscard]] bool IsTest(const std::filesystem::path& root, const std::string& suite_and_name);

}  // namespace osteon::app
