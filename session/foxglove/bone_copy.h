#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// A copy of a recording with the carved bone in it.
struct BoneCopy {
  std::filesystem::path file;
  std::uint64_t messages{0};   ///< of the recording
  int states{0};               ///< of the bone
  std::uint64_t triangles{0};  ///< in all of these states
  std::uint64_t bytes{0};      ///< of the file
};

/// Copies a recording, every message as it is, and adds topic `bone` for Foxglove and Lichtblick, in place of
/// the run's coarser one: the whole surface at the start, then the bricks that changed, `step_s` apart by log
/// time. One state of the bone is in memory at a time. `file` appears whole or not at all.
/// @param setup  the cell of the recording, with its solid or balls   @param step_s  > 0
/// @returns the error names the file and the reason
[[nodiscard]] tl::expected<BoneCopy, std::string> CopyWithBone(const std::filesystem::path& recording,
                                                               const CellSetup& setup, double step_s,
                                                               const std::filesystem::path& file);

}  // namespace osteon::session
