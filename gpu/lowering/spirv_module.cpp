#include "gpu/lowering/spirv_module.h"

#include <set>

namespace osteon::gpu::spirv {

// The first word of an instruction has the instruction's length in words in the upper half and its number in
// the lower half.
Module Read(const Words& words) {
  Module module{.header = {words.begin(), words.begin() + 5}, .instructions = {}};
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16)
    module.instructions.push_back({words[i] & 0xffff,
                                   {words.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                    words.begin() + static_cast<std::ptrdiff_t>(i + (words[i] >> 16))}});
  return module;
}

Words Write(const Module& module) {
  Words words = module.header;
  for (const Instruction& at : module.instructions) {
    words.push_back(static_cast<Word>(at.words.size() + 1) << 16 | at.op);
    words.insert(words.end(), at.words.begin(), at.words.end());
  }
  return words;
}

bool HasTypedResult(Word op) {
  // numbers of instructions without a result: OpFunctionEnd, stores and copies of memory, decorations,
  // barriers, OpAtomicStore, OpNoLine and similar ones
  static const std::set<Word> without{56, 62, 63, 64, 71, 72, 73, 74, 75, 224, 225, 228, 317, 330, 331, 332};
  const bool is_flow = op >= 246 && op <= 257;  // merges, labels, branches, returns
  return op == kExtInst || (op >= kConstantTrue && !is_flow && !without.contains(op));
}

std::string NameOf(const Instruction& name) {
  std::string text;
  for (std::size_t i = 1; i < name.words.size(); ++i)
    for (int byte = 0; byte < 4; ++byte) {
      const char c = static_cast<char>(name.words[i] >> 8 * byte & 0xff);
      if (c == 0) return text;
      text += c;
    }
  return text;
}

}  // namespace osteon::gpu::spirv
