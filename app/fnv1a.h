#pragma once

#include <cstdint>
#include <string_view>

namespace osteon::app {

/// FNV-1a of 64 bits over all bytes added so far.
class Fnv1a {
 public:
  void Add(std::string_view bytes) {
    for (const char byte : bytes) hash_ = (hash_ ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_{0xcbf29ce484222325u};
};

}  // namespace osteon::app
