#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace osteon::studies {
class PartSet;
}

namespace osteon::app {

/// How the program was called.
struct Invocation {
  std::filesystem::path config_root;
  std::string command_line;        ///< the command that repeats the run
  std::vector<std::string> words;  ///< the command line after the program's name
  /// the items of all shards; null except when `osteon merge` runs the study
  const studies::PartSet* parts{nullptr};
};

/// A subcommand. Its constructor adds it to the help, with its options.
class Subcommand {
 public:
  explicit Subcommand(CLI::App* sub) : sub_(sub) {}
  Subcommand(const Subcommand&) = delete;
  Subcommand& operator=(const Subcommand&) = delete;
  virtual ~Subcommand() = default;

  /// Whether this subcommand was on the command line.
  [[nodiscard]] virtual bool asked() const { return sub_->parsed(); }
  /// Runs this subcommand with its parsed options. @returns the process's exit code.
  [[nodiscard]] virtual int Run(const Invocation& invocation) = 0;

 protected:
  CLI::App* const sub_;
};

/// All subcommands of a program, in the order of the help.
using Subcommands = std::vector<std::unique_ptr<Subcommand>>;

/// Runs the subcommand that was on the command line. @returns its exit code; nothing if there was none.
[[nodiscard]] inline std::optional<int> RunAsked(const Subcommands& all, const Invocation& invocation) {
  for (const auto& each : all)
    if (each->asked()) return each->Run(invocation);
  return {};
}

}  // namespace osteon::app
