#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

// How the pages' commands are run by a test: as they stand where that is quick, smaller or shorter where not,
// and by a test of their own where several processes or minutes are needed.

namespace osteon::app {

struct DocRun {
  std::vector<std::string> arguments;                          ///< after "osteon"
  std::vector<std::string> leaves;                             ///< files that must be there afterwards
  std::string elsewhere;                                       ///< "Suite.Name" of the test that runs it
  std::function<void(const std::filesystem::path&)> before{};  ///< what has to be in the folder
};

/// None where a page has a command that nothing is known about.
[[nodiscard]] std::optional<DocRun> HowToRun(const std::string& command);
/// All that something is known about.
[[nodiscard]] std::vector<std::string> CommandsKept();

/// config/, meshes under the names that the pages use.
void PutInputs(const std::filesystem::path& root, const std::filesystem::path& folder);

/// Whether a source under tests/ has the test.
[[nodiscard]] bool IsTest(const std::filesystem::path& root, const std::string& suite_and_name);

}  // namespace osteon::app
