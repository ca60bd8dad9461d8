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

/// Everything from which an engine is made. A run sends it, so that both sides have the same bone to the last
/// bit, however it was packed.
struct EngineSetup {
  simulation::Bone bone;
  simulation::Tool tool;  ///< its balls; an engine needs no mass
  PlainPose X_WG;
  simulation::CuttingParams cutting;
};

/// Little-endian, with version and CRC-32. The texts that tell where a material's figures come from are left
/// out.
[[nodiscard]] std::vector<std::uint8_t> EncodeSetup(const EngineSetup& setup);
/// Verifies everything, and allocates at most in proportion to the bytes. The error says what was found and
/// what is accepted.
[[nodiscard]] tl::expected<EngineSetup, std::string> DecodeSetup(std::span<const std::uint8_t> bytes);

}  // namespace osteon::io
