#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::base {

/// How a child process is started.
struct ChildParams {
  std::vector<std::string> words;   ///< arguments of the command line, after the program's name
  std::filesystem::path program{};  ///< file of the program; empty: this one
  std::filesystem::path folder{};   ///< the child's working folder; empty: this process's
  std::filesystem::path out{};      ///< file for the child's stdout; empty: discarded
  std::filesystem::path err{};      ///< file for the child's stderr; empty: this process's
};

/// Returns the file of a program that is installed beside this one. @param name  e.g. "osteon"
[[nodiscard]] std::filesystem::path ProgramBeside(const std::string& name);

/// Returns the number of a process that `parent` has started with `word` as an argument; 0 if there is none.
[[nodiscard]] pid_t FindChild(pid_t parent, const std::string& word);

/// A child process that runs this program or another. The child ends when this process ends, even if this
/// process is killed. Ctrl-C in the terminal does not reach the child.
class ChildProcess {
 public:
  /// Starts the process. The error says why that failed.
  [[nodiscard]] static tl::expected<std::unique_ptr<ChildProcess>, std::string> Start(ChildParams params);
  /// Kills the process if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Whether the process has ended. Call this and End from the same thread.
  [[nodiscard]] bool Ended();
  /// Sends a signal; does nothing if the process has ended. Any thread.
  void Send(int signal_number) const;
  /// Waits until the process ends by itself, and kills it (SIGKILL) if it still runs after `patience`.
  /// @returns the exit code as a shell shows it: 128 + the signal if a signal ended it.
  int End(std::chrono::milliseconds patience);

  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}

  pid_t pid_;
  int status_{0};
  std::atomic<bool> ended_{false};
};

}  // namespace osteon::base
