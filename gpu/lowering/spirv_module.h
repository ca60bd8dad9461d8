#pragma once

#include <cstdint>
#include <string>
#include <vector>

// A SPIR-V module as a list of instructions, and the numbers of the SPIR-V specification that the lowering of
// doubles uses.

namespace osteon::gpu::spirv {

using Word = std::uint32_t;
using Words = std::vector<Word>;

/// Numbers of instructions in the SPIR-V specification.
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

/// Numbers of capabilities and decorations.
inline constexpr Word kCapabilityFloat64 = 10, kArrayStride = 6, kNoContraction = 42;

/// Numbers of the functions of the instruction set GLSL.std.450.
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
  Words words;  ///< all words except the first, which has the instruction's number and length
};

struct Module {
  Words header;  ///< five words; the fourth is one more than the largest id
  std::vector<Instruction> instructions;
};

/// Read splits a module's words into instructions; Write joins them again. Neither checks that the module is
/// valid.
[[nodiscard]] Module Read(const Words& words);
[[nodiscard]] Words Write(const Module& module);

/// Whether the first two words of an instruction are the type and the id of its result. Valid for the
/// instructions that glslang generates for compute shaders.
[[nodiscard]] bool HasTypedResult(Word op);

/// Returns the name that an OpName instruction assigns.
[[nodiscard]] std::string NameOf(const Instruction& name);

}  // namespace osteon::gpu::spirv
