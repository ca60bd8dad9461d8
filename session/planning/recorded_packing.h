#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "io/recording/messages.h"
#include "session/run/adaptive_resolution.h"
#include "session/setup/cell_setup.h"
#include "simulation/fidelity/packing_level.h"

namespace osteon::session {

/// The packing of a planned cell, for its recording. @param setup  with a plan
[[nodiscard]] io::PackingRecord MakePackingRecord(const CellSetup& setup);
/// The packing that replaced the cell's, for its recording.
[[nodiscard]] io::PackingRecord MakePackingRecord(const Rezoned& rezoned);

/// Returns how fine a recorded packing is. The error names the number, what was found and what is accepted.
[[nodiscard]] tl::expected<simulation::PackingLevel, std::string> LevelOf(const io::PackingRecord& packing);

/// Says where balls are not those of the recorded packing, as with another version of the packing; empty:
/// they are.
[[nodiscard]] std::string DescribeOtherBalls(const io::PackingRecord& packing, const simulation::Bone& bone);

/// Packs the bone of a recorded cell as its run did, and sets tool, cutting and plan to the run's. Without a
/// packing the scene's own is used. A loaded bone stays. Other balls than the run's are told by
/// `setup.bone_warning`.
/// @returns an error if the recorded numbers serve no packing.
[[nodiscard]] tl::expected<void, std::string> PackAsRecorded(CellSetup& setup,
                                                             const std::optional<io::PackingRecord>& packing);

}  // namespace osteon::session
