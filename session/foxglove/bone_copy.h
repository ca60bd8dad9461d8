#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "session/setup/cell_setup.h"

namespace osteon::session {

/// Figures of a copy of a recording to which the carved bone was added.
struct BoneCopy {
  std::filesystem::path file;
  std::uint64_t messages{0};   ///< number of messages copied from the recording
  int states{0};               ///< number of states of the bone that were added
  std::uint64_t triangles{0};  ///< number of triangles in all of these states
  std::uint64_t bytes{0};      ///< size of the file
};

/// Copies a recording, and adds the topic `bone` for Foxglove and Lichtblick in place of the coarser `bone`
/// topic that the run recorded. All other messages are copied unchanged. The topic has the whole surface at
/// the start, then, every `step_s` of log time, the bricks that changed. Only one state of the bone is in
/// memory at a time. `file` is written completely or not at all.
/// @param setup  the cell of the recording, with its solid or balls  @param step_s  > 0
/// @returns the copy's figures, or an error that names the file and the reason
[[nodiscard]] tl::expected<BoneCopy, std::string> CopyWithBone(const std::filesystem::path& recording,
                                                               const CellSetup& setup, double step_s,
                                                               const std::filesystem::path& file);

}  // namespace osteon::session
