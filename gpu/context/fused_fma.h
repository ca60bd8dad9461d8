#pragma once

#include "gpu/context/context.h"

namespace osteon::gpu {

/// Tests by a computation on the device whether its fma() rounds only once. Such an fma() gives the rounding
/// error of a product in one operation instead of 17 (shaders/double_single.glsl). Vulkan does not require an
/// fma() that rounds only once, and no feature reports it. The context's device and queue must be open.
/// @throws vk::SystemError if the device fails.
[[nodiscard]] bool HasFusedFma(const Context& context);

}  // namespace osteon::gpu
