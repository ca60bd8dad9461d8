#pragma once

#include <cstdint>
#include <vector>

namespace osteon::gpu {

/// Replaces doubles in a SPIR-V module by double-singles: a double becomes a vec2, a vector of doubles an
/// array of vec2, and an operation on doubles a call of the function of shaders/double_single.glsl that has
/// its name (DsAdd for OpFAdd). Buffers keep their layout. Float operations in functions named Ds… are marked
/// NoContraction.
///
///     glslang --keep-uncalled -DOSTEON_NO_FLOAT64 ─▶ LowerFloat64 ─▶ spirv-val
///
/// Constants nearer to zero than 1e-30 become 1e-30: their reciprocals have to stay in a float's range.
/// @throws std::runtime_error where the module has an operation on doubles that is not known here.
[[nodiscard]] std::vector<std::uint32_t> LowerFloat64(const std::vector<std::uint32_t>& module);

}  // namespace osteon::gpu
