#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

namespace osteon::io {

/// All data from which an engine is made. The run sends it, so that both sides have bit-identical bones,
/// independent of how the bone was packed.
struct EngineSetup {
  simulation::Bone bone;
  simulation::Tool tool;  ///< only its balls are used; an engine does not need the tool's mass
  PlainPose X_WG;
  simulation::CuttingParams cutting;
};

/// Encodes a set-up, little-endian, with version and CRC-32. The texts about the sources of a material's
/// values are omitted.
[[nodiscard]] std::vector<std::uint8_t> EncodeSetup(const EngineSetup& setup);
/// Decodes a set-up and checks all of it. The memory that it allocates is at most proportional to the number
/// of bytes. The error says what was found and what is accepted.
[[nodiscard]] tl::expected<EngineSetup, std::string> DecodeSetup(std::span<const std::uint8_t> bytes);

}  // namespace osteon::io
