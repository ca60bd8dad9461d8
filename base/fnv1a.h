#pragma once

#include <cstdint>
#include <string_view>

namespace osteon::base {

/// FNV-1a hash, 64 bits, over everything that was added so far.
class Fnv1a {
 public:
  void Add(std::string_view bytes) {
    for (const char byte : bytes) AddWord(static_cast<unsigned char>(byte));
  }
  /// Adds 64 bits in one step, as FNV-1a adds a byte.
  void AddWord(std::uint64_t word) { hash_ = (hash_ ^ word) * 0x100000001b3u; }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_{0xcbf29ce484222325u};
};

}  // namespace osteon::base
