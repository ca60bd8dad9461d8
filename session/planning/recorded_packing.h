#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "session/run/adaptive_resolution.h"
#include "session/setup/cell_setup.h"
#include "simulation/fidelity/packing_level.h"

namespace osteon::session {

/// Makes the record of a planned cell's packing. @param setup  must have a plan
[[nodiscard]] io::PackingRecord MakePackingRecord(const CellSetup& setup);
/// Makes the record of a coarser packing that replaced the cell's packing during the run.
[[nodiscard]] io::PackingRecord MakePackingRecord(const Rezoned& rezoned);

/// Returns the level of a recorded packing. The error names the number, what was found and what is accepted.
[[nodiscard]] tl::expected<simulation::PackingLevel, std::string> LevelOf(const io::PackingRecord& packing);

/// Says how a bone's balls differ from those of the recorded packing; empty: they are the same. They differ
/// if the packing code has changed since the recording was made.
[[nodiscard]] std::string DescribeOtherBalls(const io::PackingRecord& packing, const simulation::Bone& bone);

/// Packs the bone of a recorded cell as its run did, and sets tool, cutting parameters and plan to those of
/// the run. Without a recorded packing, the bone is packed as the scene's file says. A bone that was loaded
/// from a packing file stays. If the balls differ from those of the run, `setup.bone_warning` says so.
/// @returns an error if no packing can be made from the recorded numbers.
[[nodiscard]] tl::expected<void, std::string> PackAsRecorded(CellSetup& setup,
                                                             const std::optional<io::PackingRecord>& packing);

}  // namespace osteon::session
