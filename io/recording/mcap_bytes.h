#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "io/recording/mcap.h"

// Reads and writes the little-endian fields of MCAP records.

namespace osteon::io::mcap {

template <class T>
void AppendInt(std::string& out, T value) {
  static_assert(std::is_unsigned_v<T>);
  for (std::size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

// Appends a text's length (u32) and the text.
inline void AppendString(std::string& out, std::string_view text) {
  AppendInt(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}

inline void AppendRecord(std::string& out, Opcode opcode, std::string_view content) {
  out.push_back(static_cast<char>(opcode));
  AppendInt(out, std::uint64_t{content.size()});
  out.append(content);
}

// Continues a CRC-32 over further bytes. @param crc  CRC-32 of the bytes before; 0 at the beginning
inline std::uint32_t Crc(std::uint32_t crc, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// Reads the fields of one record. Reading past the end gives zeros and clears ok().
class Cursor {
 public:
  explicit Cursor(std::span<const char> bytes) : rest_(bytes) {}

  template <class T>
  T Int() {
    T value = 0;
    const std::span<const char> bytes = ReadBytes(sizeof(T));
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value = static_cast<T>(value |
                             static_cast<T>(static_cast<T>(static_cast<unsigned char>(bytes[i])) << (8 * i)));
    return value;
  }
  std::string_view String() {
    const std::span<const char> bytes = ReadBytes(Int<std::uint32_t>());
    return {bytes.data(), bytes.size()};
  }
  [[nodiscard]] std::span<const char> rest() const { return rest_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::span<const char> ReadBytes(std::size_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      return {};
    }
    const std::span<const char> taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }

  std::span<const char> rest_;
  bool ok_{true};
};

}  // namespace osteon::io::mcap
