#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "session/procedure/prepare_session.h"

namespace osteon::app {

/// Error text for a size in `--tool KIND:D` together with `--plan`: the plan's session chooses the size.
inline constexpr const char* kSizeWithPlan =
    ": found a size with --plan, accepted a kind alone: the plan has the sizes, from the first one on";

/// The options of a procedure: `--plan`, `--session`, `--resume`, `--guidance`, `--gain-from`, `--operator`.
class ProcedureOptions {
 public:
  /// @param with_session  true: all options, for a command that runs the session; false: `--plan` and
  ///   `--operator` alone, for a simulated cell
  void Add(CLI::App& sub, bool with_session);
  /// Whether --plan was given.
  [[nodiscard]] bool asked() const { return !plan_.empty(); }
  /// Finds the plan's file and fills `choice` with the options' values. Without --plan, `choice` stays
  /// unchanged.
  /// @returns what is wrong with the plan's name; empty if nothing is
  [[nodiscard]] std::string ReadInto(const std::filesystem::path& config_root,
                                     session::ProcedureChoice& choice) const;

 private:
  std::string plan_, hand_{"expert"};
  std::filesystem::path session_, gain_from_;
  bool resume_{false};
  std::optional<double> guidance_;
};

}  // namespace osteon::app
