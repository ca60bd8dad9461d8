#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

// SPIR-V as far as the lowering of doubles knows it: numbers of the specification, and a module's
// instructions.

namespace osteon::gpu::spirv {

using Word = std::uint32_t;
using Words = std::vector<Word>;

// Numbers of the SPIR-V specification: instructions, capabilities, decorations, GLSL.std.450.
enum Op : Word {
  kName = 5,
  kExtInst = 12,
  kCapability = 17,
  kTypeVoid = 19,
  kTypeInt = 21,
  kTypeFloat = 22,
  kTypeVector = 23,
  kTypeArray = 28,
  kTypeRuntimeArray = 29,
  kTypeStruct = 30,
  kTypePointer = 32,
  kTypeFunction = 33,
  kConstantTrue = 41,
  kConstant = 43,
  kConstantComposite = 44,
  kFunction = 54,
  kFunctionEnd = 56,
  kFunctionCall = 57,
  kVariable = 59,
  kDecorate = 71,
  kVectorShuffle = 79,
  kCompositeConstruct = 80,
  kCompositeExtract = 81,
  kCopyObject = 83,
  kConvertFToU = 109,
  kConvertFToS = 110,
  kConvertSToF = 111,
  kConvertUToF = 112,
  kFConvert = 115,
  kBitcast = 124,
  kFNegate = 127,
  kFAdd = 129,
  kFSub = 131,
  kFMul = 133,
  kFDiv = 136,
  kVectorTimesScalar = 142,
  kDot = 148,
  kLogicalNot = 168,
  kSelect = 169,
  kFOrdEqual = 180,
  kFOrdNotEqual = 182,
  kFUnordNotEqual = 183,
  kFOrdLessThan = 184,
  kFOrdGreaterThan = 186,
  kFOrdLessThanEqual = 188,
  kFOrdGreaterThanEqual = 190,
  kBroadcast = 337,
  kGroupFMin = 355,
  kGroupFMax = 358,
};
inline constexpr Word kCapabilityFloat64 = 10, kArrayStride = 6, kNoContraction = 42;
enum Glsl : Word {
  kFAbs = 4,
  kFloor = 8,
  kSqrt = 31,
  kFMin = 37,
  kFMax = 40,
  kFClamp = 43,
  kFma = 50,
  kPackDouble = 59,
  kUnpackDouble = 65,
  kLength = 66,
  kCross = 68,
  kNormalize = 69,
};

struct Instruction {
  Word op;
  Words words;  // without the first one, which has the instruction's number and length
};

/// The instructions of a module, in their order. @param module  complete, its header of five words included
[[nodiscard]] inline std::vector<Instruction> InstructionsOf(const Words& module) {
  std::vector<Instruction> instructions;
  for (std::size_t i = 5; i < module.size(); i += module[i] >> 16)
    instructions.push_back({module[i] & 0xffff,
                            {module.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                             module.begin() + static_cast<std::ptrdiff_t>(i + (module[i] >> 16))}});
  return instructions;
}

/// A text of zero-ended UTF-8, as in kName.
[[nodiscard]] inline std::string TextOf(std::span<const Word> words) {
  std::string text;
  for (const Word word : words)
    for (int byte = 0; byte < 4; ++byte) {
      const char c = static_cast<char>(word >> 8 * byte & 0xff);
      if (c == 0) return text;
      text += c;
    }
  return text;
}

}  // namespace osteon::gpu::spirv
