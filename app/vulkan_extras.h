#pragma once

#include <optional>

#include "gpu/vulkan_engine.h"

// What the Vulkan engine says of itself where it does: culling off, and how much a frame worked on.

namespace osteon::app {

/// False where this engine can't do without culling.
template <typename Params>
[[nodiscard]] bool SetBruteForce(Params& params) {
  if constexpr (requires { params.brute_force = true; }) {
    params.brute_force = true;
    return true;
  } else {
    return false;
  }
}

/// Balls that the last frame worked on.
template <typename Engine>
[[nodiscard]] std::optional<double> ActiveBalls(const Engine& engine) {
  if constexpr (requires { engine.LastFrameStats().active_balls; }) {
    return static_cast<double>(engine.LastFrameStats().active_balls);
  } else {
    return std::nullopt;
  }
}

}  // namespace osteon::app
