#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"

namespace osteon::app {

/// The options --mesh, --cup and --scale of a command that reads a recording. They name the mesh file of the
/// run's bone, which the recording does not contain.
class RecordedMeshOptions {
 public:
  void AddTo(CLI::App& command);

  /// @returns the choice; nothing if --mesh is not given. The error says what is wrong with --cup.
  [[nodiscard]] tl::expected<std::optional<session::MeshChoice>, std::string> Read() const;

 private:
  session::MeshChoice mesh_;
  std::string cup_;
};

}  // namespace osteon::app
