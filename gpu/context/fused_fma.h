#pragma once

#include "gpu/context/context.h"

namespace osteon::gpu {

/// Finds out, by a computation on the device, whether its fma() rounds only once. If so, fma() gives the
/// rounding error of a product, which takes 17 operations otherwise (shaders/double_single.glsl). Vulkan does
/// not require this, and no feature reports it. Needs the device and its queue.
/// @throws vk::SystemError if the device fails.
[[nodiscard]] bool HasFusedFma(const Context& context);

}  // namespace osteon::gpu
