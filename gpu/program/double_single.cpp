#include "gpu/program/double_single.h"

#include <cstring>

namespace osteon::gpu {
namespace {

// Applies `change` to the bits of all doubles of a frame: the members of DoublePrecision before `engaged`.
template <class Change>
void ChangeDoubles(Frame& frame, Change change) {
  constexpr std::size_t kDoubles = offsetof(DoublePrecision, engaged) / sizeof(double);
  auto* const bytes = reinterpret_cast<std::byte*>(&frame.exact);
  for (std::size_t i = 0; i < kDoubles; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, bytes + i * sizeof bits, sizeof bits);
    bits = change(bits);
    std::memcpy(bytes + i * sizeof bits, &bits, sizeof bits);
  }
}

}  // namespace

void ToDoubleSingles(Frame& frame) {
  ChangeDoubles(frame, [](std::uint64_t bits) { return ToDoubleSingle(std::bit_cast<double>(bits)); });
}

void FromDoubleSingles(Frame& frame) {
  ChangeDoubles(frame,
                [](std::uint64_t bits) { return std::bit_cast<std::uint64_t>(FromDoubleSingle(bits)); });
  constexpr Sum64 kFinerUnits = Sum64{1} << (kUnitBits - kFloatUnitBits);
  for (Sum64& sum : frame.exact.engaged) sum *= kFinerUnits;
  for (Sum64& sum : frame.exact.face_sums) sum *= kFinerUnits;
  frame.contact_key = frame.contact_key == kNoContactKey
                          ? frame.contact_key
                          : std::bit_cast<Key64>(FromDoubleSingleKey(frame.contact_key));
}

}  // namespace osteon::gpu
