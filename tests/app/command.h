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

// The built command, run as a user runs it: its own process, its own folder.

namespace osteon::app {

using io::test::TemporaryFolder;

struct CommandResult {
  int exit_code{-1};  ///< as a shell shows it: 128 + the signal where one ended the process
  std::string out, err;
};

/// Of a command's run; under a sanitizer each takes up to ten times as long.
#if defined(OSTEON_SANITIZED)
inline constexpr std::chrono::seconds kRunLimit{3000};
#else
inline constexpr std::chrono::seconds kRunLimit{300};
#endif

/// Descriptors to print to; kFile: a file that Out() or Err() reads, kClosed: there is none at all.
struct CommandStreams {
  static constexpr int kFile = -1, kClosed = -2;
  int out{kFile}, err{kFile};
};

/// `osteon ARGUMENTS` in a folder, with OSTEON_ROOT set to the sources; not through a shell.
class Command {
 public:
  /// @param environment  "NAME=value", added to this process's or put in place of what it has
  /// @param streams  where it prints to
  Command(const std::filesystem::path& folder, std::vector<std::string> arguments,
          const std::vector<std::string>& environment = {}, const CommandStreams& streams = {});
  /// Kills a process that still runs.
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  void Send(int signal_number) const;
  /// What it has printed so far.
  [[nodiscard]] std::string Out() const;
  [[nodiscard]] std::string Err() const;
  /// Looks at the condition now and then until it holds. False where the process ended or the time is up
  /// first.
  [[nodiscard]] bool WaitUntil(const std::function<bool()>& condition,
                               std::chrono::seconds limit = kRunLimit / 5);
  /// Waits for its end; kills it after the limit, exit code 137.
  CommandResult Wait(std::chrono::seconds limit = kRunLimit);

 private:
  [[nodiscard]] bool Ended();

  std::filesystem::path out_, err_;
  pid_t pid_{-1};
  int status_{0};
  bool ended_{false};
};

/// Runs it to its end.
[[nodiscard]] CommandResult RunCommand(const std::filesystem::path& folder,
                                       std::vector<std::string> arguments,
                                       const std::vector<std::string>& environment = {});

/// A file with one JSON object; a test failure, and null, where it is anything else.
[[nodiscard]] nlohmann::json ReadJson(const std::filesystem::path& file);
/// A recording, which must be readable and complete.
[[nodiscard]] io::Recording ReadComplete(const std::filesystem::path& file);

}  // namespace osteon::app
