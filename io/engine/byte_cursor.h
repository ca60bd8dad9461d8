#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "base/marker.h"

namespace osteon::io {

static_assert(std::endian::native == std::endian::little, "numbers cross as they lie in memory");

/// Appends numbers, little-endian, to a buffer of fixed size. After the first value that does not fit,
/// nothing more is written, and ok() is false.
class ByteWriter {
 public:
  explicit ByteWriter(std::span<std::uint8_t> room) : room_(room) {}

  template <class T>
  void Put(const T& value) OSTEON_RT {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    PutBytes({reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  }
  void PutBytes(std::span<const std::uint8_t> bytes) OSTEON_RT {
    ok_ = ok_ && bytes.size() <= room_.size() - at_;
    if (!ok_ || bytes.empty()) return;
    std::memcpy(room_.data() + at_, bytes.data(), bytes.size());
    at_ += bytes.size();
  }
  /// Number of bytes written.
  [[nodiscard]] std::size_t size() const OSTEON_RT { return at_; }
  [[nodiscard]] bool ok() const OSTEON_RT { return ok_; }

 private:
  std::span<std::uint8_t> room_;
  std::size_t at_{0};
  bool ok_{true};
};

/// Reads numbers, little-endian, from bytes. A read beyond the end returns zero, and ok() is false from then
/// on.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <class T>
  void Get(T& value) OSTEON_RT {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    value = T{};
    if (const auto taken = GetBytes(sizeof value); !taken.empty())
      std::memcpy(&value, taken.data(), sizeof value);
  }
  template <class T>
  [[nodiscard]] T Get() OSTEON_RT {
    T value;
    Get(value);
    return value;
  }
  /// Returns the next `size` bytes; empty if fewer are left.
  [[nodiscard]] std::span<const std::uint8_t> GetBytes(std::size_t size) OSTEON_RT {
    ok_ = ok_ && size <= bytes_.size() - at_;
    if (!ok_) return {};
    at_ += size;
    return bytes_.subspan(at_ - size, size);
  }
  /// Number of bytes not read yet.
  [[nodiscard]] std::size_t left() const OSTEON_RT { return bytes_.size() - at_; }
  [[nodiscard]] bool ok() const OSTEON_RT { return ok_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_{0};
  bool ok_{true};
};

}  // namespace osteon::io
