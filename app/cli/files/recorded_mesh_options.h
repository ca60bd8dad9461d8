#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"

namespace osteon::app {

/// The options --mesh, --cup and --scale of a command that reads a run whose bone was of a file.
class RecordedMeshOptions {
 public:
  void AddTo(CLI::App& command);

  /// @returns nothing where --mesh is not given; the error says what is wrong with the cup.
  [[nodiscard]] tl::expected<std::optional<session::MeshChoice>, std::string> Read() const;

 private:
  session::MeshChoice mesh_;
  std::string cup_;
};

}  // namespace osteon::app
