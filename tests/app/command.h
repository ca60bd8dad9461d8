#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/recording/recording_reader.h"
#include "tests/io/temporary_folder.h"

// Runs the built command as a user does: in its own process and its own folder.

namespace osteon::app {

using io::test::TemporaryFolder;

/// How a command ended, and what it printed.
struct CommandResult {
  int exit_code{-1};  ///< as a shell shows it: 128 + the signal's number if a signal ended the process
  std::string out, err;
};

/// Time limit of a command's run. With a sanitizer, a run takes up to ten times as long.
#if defined(OSTEON_SANITIZED)
inline constexpr std::chrono::seconds kRunLimit{3000};
#else
inline constexpr std::chrono::seconds kRunLimit{300};
#endif

/// Destinations of standard output and standard error. kFile: a file that Out() or Err() reads; kClosed: no
/// descriptor at all.
struct CommandStreams {
  static constexpr int kFile = -1, kClosed = -2;
  int out{kFile}, err{kFile};
};

/// A process that runs `osteon ARGUMENTS` in a folder. OSTEON_ROOT is set to the sources. No shell is
/// involved.
class Command {
 public:
  /// @param environment  "NAME=value" each; added to this process's environment, or replacing values in it
  /// @param streams  where the process prints to
  Command(const std::filesystem::path& folder, std::vector<std::string> arguments,
          const std::vector<std::string>& environment = {}, const CommandStreams& streams = {});
  /// Kills the process if it still runs.
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  void Send(int signal_number) const;
  /// Standard output so far, if it goes to a file; below, standard error.
  [[nodiscard]] std::string Out() const;
  [[nodiscard]] std::string Err() const;
  /// Polls the condition until it holds. Returns false if the process ends or the time limit passes first.
  [[nodiscard]] bool WaitUntil(const std::function<bool()>& condition,
                               std::chrono::seconds limit = kRunLimit / 5);
  /// Waits for the end of the process. At the time limit it kills the process, whose exit code is then 137.
  CommandResult Wait(std::chrono::seconds limit = kRunLimit);

 private:
  [[nodiscard]] bool Ended();

  std::filesystem::path out_, err_;
  pid_t pid_{-1};
  int status_{0};
  bool ended_{false};
};

/// Runs a command to its end.
[[nodiscard]] CommandResult RunCommand(const std::filesystem::path& folder,
                                       std::vector<std::string> arguments,
                                       const std::vector<std::string>& environment = {});

/// Reads a file with one JSON object. If the file holds anything else, the test fails and the result is null.
[[nodiscard]] nlohmann::json ReadJson(const std::filesystem::path& file);
/// Reads a recording, which must be readable and complete.
[[nodiscard]] io::Recording ReadComplete(const std::filesystem::path& file);

}  // namespace osteon::app
