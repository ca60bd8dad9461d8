#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

// Shared parts of the fuzz targets: a reader of the fuzzer's input, and the function Claim. A claim is a
// property that must hold for any input.

namespace osteon::fuzz {

/// Reads the fuzzer's bytes piece by piece. Behind the last byte, Byte and Word return zeros.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::uint8_t Byte() {
    const auto one = Bytes(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  /// Reads a number of two bytes, little-endian.
  std::uint16_t Word() {
    const unsigned low = Byte();
    return static_cast<std::uint16_t>(low | unsigned{Byte()} << 8);
  }
  /// Reads at most `size` bytes.
  std::span<const std::uint8_t> Bytes(std::size_t size) {
    const auto bytes = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }
  std::span<const std::uint8_t> Rest() { return Bytes(rest_.size()); }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Ends the target's run with an exception if the claim is false. libFuzzer counts an uncaught exception as a
/// crash and keeps the input.
inline void Claim(bool holds, const char* claim) {
  if (!holds) throw std::logic_error(claim);
}

}  // namespace osteon::fuzz
