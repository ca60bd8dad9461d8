#pragma once

#include "gpu/context/context.h"

namespace osteon::gpu {

/// True where the device's fma() rounds once, found by computing on it: it then gives what the rounding of a
/// product leaves, which takes 17 operations otherwise (shaders/double_single.glsl). Vulkan doesn't require
/// it, and no feature tells. Needs the device and its queue. @throws vk::SystemError where the device fails.
[[nodiscard]] bool HasFusedFma(const Context& context);

}  // namespace osteon::gpu
