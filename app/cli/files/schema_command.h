#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// The subcommand `schema` of the command line: JSON Schema of every kind of YAML file, from the readers' own
/// keys (config/reading/strict/key_table.h).
class SchemaCommand {
 public:
  explicit SchemaCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root) const;

 private:
  std::filesystem::path out_{"schemas"};
  CLI::App* sub_;
};

}  // namespace osteon::app
