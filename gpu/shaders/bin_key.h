// Key for finding the nearest pair of a bin: the smallest key wins. Included by C++ and GLSL.
//
//     63                38 37              14 13            0
//     score's units (26)   bone ball (24)     tool ball (14)
//
// For a bone of more than 2^24 balls, the ball's index takes up to kMaxBoneBits bits, and the score loses as
// many of its lowest bits.
#ifndef OSTEON_GPU_BIN_KEY_H
#define OSTEON_GPU_BIN_KEY_H

#include "gpu/shaders/layout.h"

#ifdef __cplusplus
namespace osteon::gpu {
#define OSTEON_CONST inline constexpr
#define OSTEON_FUNCTION [[nodiscard]] constexpr
#else
#define OSTEON_CONST const
#define OSTEON_FUNCTION
#endif

OSTEON_CONST uint kScoreBits = 26, kMinBoneBits = 24, kMaxBoneBits = 28;

// A pair's score (gap plus direction cost) in integer units; a larger score has more units:
//
//     -33 … -0.97 mm    2^-15 mm per unit: the tool may be as deep as this in bone
//     -0.97 … 0.97 mm   2^-25 mm per unit
//     0.97 … 33 mm      2^-15 mm per unit: a normal's enlargement may be as large as this
//
// Each range continues at the unit where the previous range ends: at 2^20, then at 66060288.
#define OSTEON_SCORE_UNITS(Number)                                          \
  OSTEON_FUNCTION uint ScoreUnits(Number score) {                           \
    Number deep = score + Number(32.96875), far = score - Number(0.96875);  \
    deep = deep > Number(0.0) ? deep : Number(0.0);                         \
    far = far < Number(31.96875) ? far : Number(31.96875);                  \
    if (score < Number(-0.96875)) return uint(deep * Number(32768.0));      \
    if (far >= Number(0.0)) return 66060288u + uint(far * Number(32768.0)); \
    return uint((score + Number(1.0)) * Number(33554432.0));                \
  }
OSTEON_SCORE_UNITS(float)
OSTEON_SCORE_UNITS(double)
#undef OSTEON_SCORE_UNITS

// Returns the upper bits of the score's units, which are stored in a key with `bone_bits` bits for the bone
// ball.
OSTEON_FUNCTION uint KeptUnits(uint units, uint bone_bits) { return units >> (bone_bits - kMinBoneBits); }

// Returns the units stored in a key (as KeptUnits returns them), given the upper half of the key's 64 bits.
OSTEON_FUNCTION uint UnitsOfHalf(uint upper_half, uint bone_bits) {
  return upper_half >> (bone_bits + kToolBits - 32u);
}

#ifdef OSTEON_NO_INT64
Key64 BinKey(uint units, uint bone_ball, uint tool_ball, uint bone_bits) {
  return Key64(bone_ball << kToolBits | tool_ball,
               KeptUnits(units, bone_bits) << (bone_bits + kToolBits - 32u) | bone_ball >> (32u - kToolBits));
}
uint UnitsOfKey(Key64 key, uint bone_bits) { return UnitsOfHalf(key.y, bone_bits); }
uint BoneOfKey(Key64 key, uint bone_bits) {
  return (key.x >> kToolBits | key.y << (32u - kToolBits)) & ((1u << bone_bits) - 1u);
}
uint ToolOfKey(Key64 key) { return key.x & ((1u << kToolBits) - 1u); }
#else
OSTEON_FUNCTION Key64 BinKey(uint units, uint bone_ball, uint tool_ball, uint bone_bits) {
  return (Key64(KeptUnits(units, bone_bits)) << (bone_bits + kToolBits)) | (Key64(bone_ball) << kToolBits) |
         Key64(tool_ball);
}
OSTEON_FUNCTION uint UnitsOfKey(Key64 key, uint bone_bits) { return uint(key >> (bone_bits + kToolBits)); }
OSTEON_FUNCTION uint BoneOfKey(Key64 key, uint bone_bits) {
  return uint(key >> kToolBits) & ((1u << bone_bits) - 1u);
}
OSTEON_FUNCTION uint ToolOfKey(Key64 key) { return uint(key) & ((1u << kToolBits) - 1u); }
#endif

#ifdef __cplusplus
static_assert(kScoreBits + kMinBoneBits + kToolBits == 64 && kMinBoneBits + kToolBits >= 32);

// Returns the number of bits that an index of one of `balls` bone balls needs.
[[nodiscard]] constexpr uint BoneBits(std::size_t balls) {
  uint bits = kMinBoneBits;
  while (bits < kMaxBoneBits && (balls - 1) >> bits != 0 && balls > 0) ++bits;
  return bits;
}
inline constexpr std::size_t kMaxBoneBalls = std::size_t{1} << kMaxBoneBits;
}  // namespace osteon::gpu
#endif
#undef OSTEON_FUNCTION
#undef OSTEON_CONST
#endif
