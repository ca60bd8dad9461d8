#include "gpu/lowering/float64_lowering.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "gpu/lowering/spirv_module.h"

namespace osteon::gpu {
namespace {

using namespace spirv;

// Smallest magnitude of a constant other than 0. The reciprocal of this value stays within a float's range.
constexpr double kMinConstant = 1e-30;

// Replaces a module's instructions in one pass over them. A "pair" is a double-single: a vec2 that represents
// a double.
class Lowering {
 public:
  explicit Lowering(Module module) : header_(std::move(module.header)), in_(std::move(module.instructions)) {}

  Words Run() {
    FindNames();
    FindTypes();
    std::size_t i = 0;
    for (; in_[i].op != kFunction; ++i) LowerGlobal(in_[i]);
    for (; i < in_.size(); ++i) LowerInFunction(in_[i]);
    return Assemble();
  }

 private:
  // Finds the functions of double_single.glsl. A function's name in the module includes its parameters:
  // "DsAdd(vf2;vf2;".
  void FindNames() {
    for (const Instruction& instruction : in_)
      if (instruction.op == kName) {
        const std::string name = NameOf(instruction);
        if (name.starts_with("Ds") && name.find('(') != name.npos)
          functions_[name.substr(0, name.find('('))] = instruction.words[0];
      }
  }

  // Finds the ids of the types that are replaced or used, and the type of each value.
  void FindTypes() {
    for (const Instruction& instruction : in_) {
      if (instruction.op == kTypeFloat && instruction.words[1] == 64) double_ = instruction.words[0];
      if (instruction.op == kTypeFloat && instruction.words[1] == 32) float_ = instruction.words[0];
      if (instruction.op == kTypeInt && instruction.words[1] == 32 && instruction.words[2] == 0)
        uint_ = instruction.words[0];
      if (instruction.op == kTypeVector)
        vectors_[instruction.words[0]] = {instruction.words[1], instruction.words[2]};
      if (instruction.op == kTypeVector && instruction.words[1] == float_ && instruction.words[2] == 2)
        pair_ = instruction.words[0];
      if (instruction.op == kFunction) function_result_[instruction.words[1]] = instruction.words[0];
      if (HasTypedResult(instruction.op)) type_of_[instruction.words[1]] = instruction.words[0];
    }
    if (double_ == 0 || pair_ == 0) throw std::runtime_error("no doubles, or no double_single.glsl");
  }

  // Number of doubles in a scalar or vector type; 0 for a type without doubles.
  [[nodiscard]] Word DoublesInType(Word type) const {
    if (type == double_) return 1;
    const auto found = vectors_.find(type);
    return found != vectors_.end() && found->second.first == double_ ? found->second.second : 0;
  }
  [[nodiscard]] Word DoublesIn(Word value) const {
    const auto found = type_of_.find(value);
    return found == type_of_.end() ? 0 : DoublesInType(found->second);
  }
  // Number of components of a value of any vector or scalar type.
  [[nodiscard]] Word ComponentCount(Word type) const {
    const auto found = vectors_.find(type);
    return found == vectors_.end() ? 1 : found->second.second;
  }
  [[nodiscard]] Word LoweredType(Word type) const { return type == double_ ? pair_ : type; }
  Word NewId() { return header_[3]++; }

  // Emit appends an instruction. EmitNew also gives the instruction a new result id and returns it; `type` is
  // the result's type before the lowering.
  void Emit(Op op, Words words) { out_.push_back({op, std::move(words)}); }
  Word EmitNew(Op op, Word type, std::initializer_list<Word> rest) {
    const Word id = NewId();
    Words words{LoweredType(type), id};
    words.insert(words.end(), rest);
    Emit(op, std::move(words));
    type_of_[id] = type;
    return id;
  }
  // Emits a call of a function of double_single.glsl, with `id` as the id of its result.
  void CallInto(Word id, const char* name, const Words& arguments) {
    const auto found = functions_.find(name);
    if (found == functions_.end()) throw std::runtime_error(std::string("no function ") + name);
    Words words{function_result_[found->second], id, found->second};
    words.insert(words.end(), arguments.begin(), arguments.end());
    Emit(kFunctionCall, std::move(words));
  }
  Word Call(const char* name, const Words& arguments) {
    const Word id = NewId();
    CallInto(id, name, arguments);
    return id;
  }
  // Returns the id of component i; a scalar is its own component.
  Word Component(Word value, Word i) {
    const Word type = type_of_.at(value);
    if (type == double_ || ComponentCount(type) == 1) return value;
    return EmitNew(kCompositeExtract, vectors_.at(type).first, {value, i});
  }
  // Emits the instruction's result as a composite of these components.
  void EmitComposite(const Instruction& instruction, const Words& components) {
    Words words{LoweredType(instruction.words[0]), instruction.words[1]};
    if (components.size() == 1) throw std::logic_error("a scalar is not built");
    words.insert(words.end(), components.begin(), components.end());
    Emit(kCompositeConstruct, std::move(words));
  }
  // Lowers an operation component by component: `of(i, id)` emits component i with the result `id`.
  template <class OfComponent>
  void LowerEachComponent(const Instruction& instruction, OfComponent&& of) {
    const Word size = ComponentCount(instruction.words[0]);
    if (size == 1) return of(0, instruction.words[1]);
    Words components;
    for (Word i = 0; i < size; ++i) {
      components.push_back(NewId());
      of(i, components.back());
    }
    EmitComposite(instruction, components);
  }
  // Lowers an operation to one call for each component.
  void CallForEachComponent(const Instruction& instruction, const char* name, const Words& operands) {
    LowerEachComponent(instruction, [&](Word i, Word id) {
      Words component_operands;
      for (const Word operand : operands) component_operands.push_back(Component(operand, i));
      CallInto(id, name, component_operands);
    });
  }
  // Returns the id of the float that component i equals exactly (a converted or a constant float); 0 if there
  // is none.
  Word FloatOf(Word value, Word i) {
    const auto found = float_of_.find(value);
    if (found == float_of_.end()) return 0;
    return Component(found->second, i);
  }
  // Add, Subtract and Multiply emit component i of the result as `id`. If one operand equals a float exactly,
  // they call DsAddFloat or DsMulFloat.
  void Add(Word id, Word a, Word b, Word i) {
    if (const Word of_b = FloatOf(b, i)) return CallInto(id, "DsAddFloat", {Component(a, i), of_b});
    if (const Word of_a = FloatOf(a, i)) return CallInto(id, "DsAddFloat", {Component(b, i), of_a});
    CallInto(id, "DsAdd", {Component(a, i), Component(b, i)});
  }
  void Subtract(Word id, Word a, Word b, Word i) {
    if (const Word of_b = FloatOf(b, i))
      return CallInto(id, "DsAddFloat", {Component(a, i), EmitNew(kFNegate, float_, {of_b})});
    if (const Word of_a = FloatOf(a, i))
      return CallInto(id, "DsAddFloat", {EmitNew(kFNegate, double_, {Component(b, i)}), of_a});
    CallInto(id, "DsSub", {Component(a, i), Component(b, i)});
  }
  void Multiply(Word id, Word a, Word b, Word i) {
    if (const Word of_b = FloatOf(b, i)) return CallInto(id, "DsMulFloat", {Component(a, i), of_b});
    if (const Word of_a = FloatOf(a, i)) return CallInto(id, "DsMulFloat", {Component(b, i), of_a});
    CallInto(id, "DsMul", {Component(a, i), Component(b, i)});
  }
  Word Dot(Word a, Word b) {
    if (DoublesIn(a) == 3)
      return Call("DsDot", {Component(a, 0), Component(a, 1), Component(a, 2), Component(b, 0),
                            Component(b, 1), Component(b, 2)});
    Word sum = 0;
    for (Word i = 0; i < DoublesIn(a); ++i) {
      const Word product = Call("DsMul", {Component(a, i), Component(b, i)});
      sum = i == 0 ? product : Call("DsAdd", {sum, product});
    }
    return sum;
  }

  // ---- module scope: types, constants, decorations

  Word FloatConstant(float value) {
    const Word id = NewId();
    Emit(kConstant, {float_, id, std::bit_cast<Word>(value)});
    type_of_[id] = float_;
    return id;
  }

  // Emits ahead of all other types the types float, uint and vec2 and the constants that the lowered types
  // and instructions refer to.
  void EmitTypes() {
    for (const Instruction& instruction : in_)
      if ((instruction.op == kTypeFloat || instruction.op == kTypeInt || instruction.op == kTypeVector) &&
          (instruction.words[0] == float_ || instruction.words[0] == uint_ || instruction.words[0] == pair_))
        out_.push_back(instruction);
    for (Word size = 2; size <= 4; ++size) {
      sizes_[size] = NewId();
      Emit(kConstant, {uint_, sizes_[size], size});
    }
    zero_ = FloatConstant(0.0f);
    types_begun_ = true;
  }

  // Lowers one instruction outside functions.
  void LowerGlobal(const Instruction& instruction) {
    const Words& w = instruction.words;
    if (instruction.op == kCapability && w[0] == kCapabilityFloat64) return;
    if (instruction.op == kDecorate && w[1] == kNoContraction && DoublesIn(w[0]) > 0) return;
    if (!types_begun_ && instruction.op >= kTypeVoid && instruction.op <= kTypeFunction) {
      end_of_decorations_ = out_.size();
      EmitTypes();
    }
    if (instruction.op <= kTypeFunction && instruction.op >= kTypeVoid &&
        (w[0] == float_ || w[0] == uint_ || w[0] == pair_ || w[0] == double_))
      return;
    Instruction lowered = instruction;
    if (instruction.op == kTypeVector && w[1] == double_) {
      lowered = {kTypeArray, {w[0], pair_, sizes_[w[2]]}};
      decorations_.push_back({kDecorate, {w[0], kArrayStride, 8}});
    } else if (instruction.op == kConstant && w[0] == double_) {
      double value = std::bit_cast<double>(static_cast<std::uint64_t>(w[3]) << 32 | w[2]);
      if (value != 0.0 && std::abs(value) < kMinConstant) value = std::copysign(kMinConstant, value);
      const float nearest = static_cast<float>(value);
      const Word x = FloatConstant(nearest),
                 y = FloatConstant(static_cast<float>(value - static_cast<double>(nearest)));
      lowered = {kConstantComposite, {pair_, w[1], x, y}};
      if (value == static_cast<double>(nearest)) float_of_[w[1]] = x;
    } else if (instruction.op == kTypeArray || instruction.op == kTypeRuntimeArray ||
               instruction.op == kTypeStruct || instruction.op == kTypePointer ||
               instruction.op == kTypeFunction) {
      // in a pointer type, the storage class precedes the type
      const std::size_t first = instruction.op == kTypePointer ? 2 : 1;
      for (std::size_t i = first; i < (instruction.op == kTypeArray ? 2 : w.size()); ++i)
        lowered.words[i] = LoweredType(w[i]);
      if (instruction.op == kTypeFunction) {
        // different function types may become equal; keep only the first one, because SPIR-V forbids
        // duplicates
        const Words signature(lowered.words.begin() + 1, lowered.words.end());
        const auto [known, is_new] = signatures_.try_emplace(signature, w[0]);
        same_signature_[w[0]] = known->second;
        if (!is_new) return;
      }
    } else if (instruction.op >= kConstantTrue && instruction.op <= kVariable) {
      lowered.words[0] = LoweredType(w[0]);
    }
    out_.push_back(std::move(lowered));
  }

  // ---- functions

  // Lowers one instruction of the shader's functions; copies an instruction of double_single.glsl's
  // functions.
  void LowerInFunction(const Instruction& instruction) {
    const Words& w = instruction.words;
    if (instruction.op == kFunction) {
      in_pair_function_ =
          std::ranges::any_of(functions_, [&](const auto& named) { return named.second == w[1]; });
      Emit(kFunction, {LoweredType(w[0]), w[1], w[2], same_signature_.at(w[3])});
      return;
    }
    if (in_pair_function_) {
      if (instruction.op == kFAdd || instruction.op == kFSub || instruction.op == kFMul ||
          instruction.op == kFDiv || (instruction.op == kExtInst && w[3] == kFma))
        decorations_.push_back({kDecorate, {w[1], kNoContraction}});
      out_.push_back(instruction);
      return;
    }
    const bool has_result = HasTypedResult(instruction.op);
    const Word result_doubles = has_result ? DoublesInType(w[0]) : 0;
    const Word operand_doubles =
        has_result && w.size() > 2 ? DoublesIn(instruction.op == kExtInst ? w.at(4) : w[2]) : 0;
    if (result_doubles > 0 || operand_doubles > 0) {
      if (LowerArithmetic(instruction, result_doubles)) return;
    }
    Instruction lowered = instruction;
    if (has_result) lowered.words[0] = LoweredType(w[0]);
    out_.push_back(std::move(lowered));
  }

  // Lowers an instruction whose result consists of `result_doubles` doubles. Returns false if the instruction
  // stays valid with a lowered result type; the caller then copies it.
  bool LowerArithmetic(const Instruction& instruction, Word result_doubles) {
    const Words& w = instruction.words;
    switch (instruction.op) {
      case kFAdd:
        return LowerEachComponent(instruction, [&](Word i, Word id) { Add(id, w[2], w[3], i); }), true;
      case kFSub:
        return LowerEachComponent(instruction, [&](Word i, Word id) { Subtract(id, w[2], w[3], i); }), true;
      case kFMul:
        return LowerEachComponent(instruction, [&](Word i, Word id) { Multiply(id, w[2], w[3], i); }), true;
      case kFDiv:
        return CallForEachComponent(instruction, "DsDiv", {w[2], w[3]}), true;
      case kVectorTimesScalar:
        return LowerEachComponent(instruction, [&](Word i, Word id) { Multiply(id, w[2], w[3], i); }), true;
      case kDot:
        return Emit(kCopyObject, {pair_, w[1], Dot(w[2], w[3])}), true;
      case kFNegate:
        return LowerEachComponent(instruction,
                                  [&](Word i, Word id) {
                                    Emit(kFNegate, {pair_, id, Component(w[2], i)});
                                  }),
               true;
      case kFOrdEqual:
        return CallForEachComponent(instruction, "DsEqual", {w[2], w[3]}), true;
      case kFOrdNotEqual:
      case kFUnordNotEqual:
        return LowerEachComponent(
                   instruction,
                   [&](Word i, Word id) {
                     const Word equal = Call("DsEqual", {Component(w[2], i), Component(w[3], i)});
                     Emit(kLogicalNot, {function_result_[functions_.at("DsEqual")], id, equal});
                   }),
               true;
      case kFOrdLessThan:
        return CallForEachComponent(instruction, "DsLess", {w[2], w[3]}), true;
      case kFOrdGreaterThan:
        return CallForEachComponent(instruction, "DsLess", {w[3], w[2]}), true;
      case kFOrdLessThanEqual:
        return CallForEachComponent(instruction, "DsLessEqual", {w[2], w[3]}), true;
      case kFOrdGreaterThanEqual:
        return CallForEachComponent(instruction, "DsLessEqual", {w[3], w[2]}), true;
      case kFConvert:
        if (result_doubles > 0) float_of_[w[1]] = w[2];
        return LowerEachComponent(instruction,
                                  [&](Word i, Word id) {
                                    if (result_doubles > 0)
                                      Emit(kCompositeConstruct, {pair_, id, Component(w[2], i), zero_});
                                    else
                                      Emit(kCompositeExtract, {float_, id, Component(w[2], i), 0});
                                  }),
               true;
      case kConvertSToF:
        return CallForEachComponent(instruction, "DsFromInt", {w[2]}), true;
      case kConvertUToF:
        return CallForEachComponent(instruction, "DsFromUint", {w[2]}), true;
      case kConvertFToS:
        return CallForEachComponent(instruction, "DsToInt", {w[2]}), true;
      case kConvertFToU:
        return CallForEachComponent(instruction, "DsToUint", {w[2]}), true;
      case kSelect:
        if (ComponentCount(type_of_.at(w[2])) == 1) return false;
        return LowerEachComponent(
                   instruction,
                   [&](Word i, Word id) {
                     Emit(kSelect, {pair_, id, Component(w[2], i), Component(w[3], i), Component(w[4], i)});
                   }),
               true;
      case kVectorShuffle: {
        Words components;
        const Word first = DoublesIn(w[2]);
        for (std::size_t i = 4; i < w.size(); ++i)
          components.push_back(w[i] < first ? Component(w[2], w[i]) : Component(w[3], w[i] - first));
        return EmitComposite(instruction, components), true;
      }
      case kCompositeConstruct: {
        if (result_doubles == 0) return false;
        Words components;
        for (std::size_t k = 2; k < w.size(); ++k)
          for (Word i = 0; i < DoublesIn(w[k]); ++i) components.push_back(Component(w[k], i));
        return EmitComposite(instruction, components), true;
      }
      case kBroadcast:
        if (result_doubles == 1) return false;
        return LowerEachComponent(instruction,
                                  [&](Word i, Word id) {
                                    Emit(kBroadcast, {pair_, id, w[2], Component(w[3], i), w[4]});
                                  }),
               true;
      case kGroupFMin:
        return CallInto(w[1], "DsSubgroupMin", {w[4]}), true;
      case kGroupFMax:
        return CallInto(w[1], "DsSubgroupMax", {w[4]}), true;
      case kExtInst:
        return LowerGlsl(instruction), true;
      default:
        if (instruction.op >= kConvertFToU && instruction.op <= kFOrdGreaterThanEqual + 1)
          throw std::runtime_error("an unknown operation on doubles: " + std::to_string(instruction.op));
        return false;
    }
  }

  // Lowers a function of GLSL.std.450.
  void LowerGlsl(const Instruction& instruction) {
    const Words& w = instruction.words;
    switch (w[3]) {
      case kFAbs:
        return CallForEachComponent(instruction, "DsAbs", {w[4]});
      case kFloor:
        return CallForEachComponent(instruction, "DsFloor", {w[4]});
      case kSqrt:
        return CallForEachComponent(instruction, "DsSqrt", {w[4]});
      case kFMin:
        return CallForEachComponent(instruction, "DsMin", {w[4], w[5]});
      case kFMax:
        return CallForEachComponent(instruction, "DsMax", {w[4], w[5]});
      case kFClamp:
        return LowerEachComponent(instruction, [&](Word i, Word id) {
          const Word low = Call("DsMax", {Component(w[4], i), Component(w[5], i)});
          CallInto(id, "DsMin", {low, Component(w[6], i)});
        });
      case kPackDouble:
      case kUnpackDouble:
        return Emit(kBitcast, {LoweredType(w[0]), w[1], w[4]});
      case kLength:
        return CallInto(w[1], "DsSqrt", {Dot(w[4], w[4])});
      case kNormalize: {
        const Word length = Call("DsSqrt", {Dot(w[4], w[4])});
        return LowerEachComponent(instruction, [&](Word i, Word id) {
          CallInto(id, "DsDiv", {Component(w[4], i), length});
        });
      }
      case kCross:
        return LowerEachComponent(instruction, [&](Word i, Word id) {
          const Word j = (i + 1) % 3, k = (i + 2) % 3;
          const Word one = Call("DsMul", {Component(w[4], j), Component(w[5], k)});
          const Word other = Call("DsMul", {Component(w[4], k), Component(w[5], j)});
          CallInto(id, "DsSub", {one, other});
        });
      default:
        throw std::runtime_error("an unknown GLSL function of doubles: " + std::to_string(w[3]));
    }
  }

  // Joins the module. SPIR-V requires the new decorations before the types.
  Words Assemble() {
    out_.insert(out_.begin() + static_cast<std::ptrdiff_t>(end_of_decorations_), decorations_.begin(),
                decorations_.end());
    return Write({.header = std::move(header_), .instructions = std::move(out_)});
  }

  Words header_;  // its fourth word: one more than the largest id
  std::vector<Instruction> in_, out_;
  std::vector<Instruction> decorations_;  // decorations that the lowering adds
  std::size_t end_of_decorations_{0};
  std::map<std::string, Word> functions_;          // ids of the functions of double_single.glsl, by name
  std::map<Word, Word> function_result_;           // result type by function id
  std::map<Word, std::pair<Word, Word>> vectors_;  // component type and number of components, by vector type
  std::map<Word, Word> type_of_;                   // type of a value in the original module
  std::map<Word, Word> float_of_;  // id of the float that a double equals exactly, by the double's id
  // id of the first function type with a signature, by the signature: result and parameter types, lowered
  std::map<Words, Word> signatures_;
  std::map<Word, Word> same_signature_;  // for each function type: the equal type that is kept
  std::map<Word, Word> sizes_;           // ids of the constants 2, 3, 4
  Word double_{0}, float_{0}, uint_{0}, pair_{0}, zero_{0};
  bool types_begun_{false}, in_pair_function_{false};
};

}  // namespace

std::vector<std::uint32_t> LowerFloat64(const std::vector<std::uint32_t>& module) {
  return Lowering(spirv::Read(module)).Run();
}

}  // namespace osteon::gpu
