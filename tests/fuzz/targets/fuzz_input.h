#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

// What the fuzz targets share: a fuzzer's bytes taken piece by piece, and claims that hold whatever they are.

namespace osteon::fuzz {

/// Zeros once the bytes are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::uint8_t Byte() {
    const auto one = Bytes(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  std::uint16_t Word() {
    const unsigned low = Byte();
    return static_cast<std::uint16_t>(low | unsigned{Byte()} << 8);
  }
  /// At most so many.
  std::span<const std::uint8_t> Bytes(std::size_t size) {
    const auto bytes = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }
  std::span<const std::uint8_t> Rest() { return Bytes(rest_.size()); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Ends the run of a target. libFuzzer takes what leaves a target for a crash and keeps the input.
inline void Claim(bool holds, const char* claim) {
  if (!holds) throw std::logic_error(claim);
}

}  // namespace osteon::fuzz
