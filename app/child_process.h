#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::app {

struct ChildParams {
  std::vector<std::string> words;  ///< of its command line, behind the program's name
  std::filesystem::path folder{};  ///< in which it works; empty: this process's
  std::filesystem::path out{};     ///< what it prints; empty: nowhere
  std::filesystem::path err{};     ///< what it complains of; empty: where this process does
};

/// This program as another process. It ends with this one, however that ends, and hears no Ctrl-C but ours.
class ChildProcess {
 public:
  /// The error says why it could not be started.
  [[nodiscard]] static tl::expected<std::unique_ptr<ChildProcess>, std::string> Start(ChildParams params);
  /// Kills it where it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// One thread.
  [[nodiscard]] bool Ended();
  /// Nothing where it has ended. Any thread.
  void Send(int signal_number) const;
  /// Waits for its end, and kills it where that takes longer.
  /// @returns the exit code as a shell shows it: 128 + the signal where one ended it.
  int End(std::chrono::milliseconds patience);

  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}

  pid_t pid_;
  int status_{0};
  std::atomic<bool> ended_{false};
};

}  // namespace osteon::app
