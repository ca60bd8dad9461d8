#pragma once

#include <cstdint>
#include <vector>

namespace osteon::gpu {

/// Replaces doubles in a SPIR-V module by double-singles. A double becomes a vec2, and a vector of doubles
/// becomes an array of vec2. An operation on doubles becomes a call of the corresponding function of
/// shaders/double_single.glsl (DsAdd for OpFAdd). Buffers keep their layout. Float operations in functions
/// named Ds… are decorated with NoContraction.
///
///     glslang --keep-uncalled -DOSTEON_NO_FLOAT64 ─▶ LowerFloat64 ─▶ spirv-val
///
/// Constants other than 0 with a magnitude below 1e-30 become 1e-30, because their reciprocals must stay in a
/// float's range.
/// @throws std::runtime_error if the module has an operation on doubles that has no replacement.
[[nodiscard]] std::vector<std::uint32_t> LowerFloat64(const std::vector<std::uint32_t>& module);

}  // namespace osteon::gpu
