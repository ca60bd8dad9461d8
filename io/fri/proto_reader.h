#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/marker.h"

// Reads a protobuf message field by field, without copying or allocating. Every step advances in the message,
// so the cost is bounded by the message's length. The caller decides which fields exist:
//
//     ProtoReader in(bytes);
//     while (in.Next()) switch (in.number()) {
//         case 1: sec = in.Uint32(); break;
//         default: in.Skip();
//       }
//     if (!in.ok()) …
//
// The first error ends the reading; values read afterwards are 0. Errors: bytes that end within a
// field; a varint of more than 64 bits or ten bytes; a tag or length of more than 32 bits or five bytes;
// field number 0; a group (only obsolete schemas have them); another wire type than the field's.

namespace osteon::io {

class ProtoReader {
 public:
  explicit ProtoReader(std::span<const std::uint8_t> bytes) OSTEON_RT : at_(bytes.data()),
                                                                        end_(bytes.data() + bytes.size()) {}

  /// Moves to the next field. One of the functions below must then read or skip its value. Returns false at
  /// the end or after an error.
  [[nodiscard]] bool Next() OSTEON_RT;
  [[nodiscard]] std::uint32_t number() const OSTEON_RT { return tag_ >> 3; }
  [[nodiscard]] bool ok() const OSTEON_RT { return ok_; }
  /// Ends the reading with an error.
  void Fail() OSTEON_RT {
    ok_ = false;
    at_ = end_;
  }

  /// Skips a value of any type.
  void Skip() OSTEON_RT;

  [[nodiscard]] std::uint64_t Uint64() OSTEON_RT { return Expect(kVarint) ? Varint() : 0; }
  /// Fails if the value exceeds 32 bits.
  [[nodiscard]] std::uint32_t Uint32() OSTEON_RT;
  /// Reads a signed integer: the low 32 bits of the value, as libprotobuf does. Some encoders write a
  /// negative number in five bytes, most in ten.
  [[nodiscard]] std::int32_t Int32() OSTEON_RT { return static_cast<std::int32_t>(Uint64()); }
  /// Reads an enum's number; a negative value becomes a large one. Fails if the value exceeds 32 bits.
  [[nodiscard]] std::uint32_t Enum() OSTEON_RT { return Expect(kVarint) ? EnumValue() : 0; }
  [[nodiscard]] double Double() OSTEON_RT { return Expect(kFixed64) ? Fixed64() : 0.0; }
  /// Reads a string, bytes or a message; the result points into the message.
  [[nodiscard]] std::span<const std::uint8_t> Bytes() OSTEON_RT;
  /// Reads a string. Fails if it is longer than max_size.
  [[nodiscard]] std::string_view Text(std::size_t max_size) OSTEON_RT;

  // Appends one or more elements of a repeated field (packed or not) to an array that has `count` elements.
  // Fails if the array is too small.

  template <std::size_t N>
  void Append(std::array<double, N>& to, std::size_t& count) OSTEON_RT {
    AppendDoubles(to.data(), N, count);
  }
  /// The same for enums.
  template <std::size_t N>
  void Append(std::array<std::uint32_t, N>& to, std::size_t& count) OSTEON_RT {
    AppendEnums(to.data(), N, count);
  }

 private:
  enum WireType : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };  // 3 and 4: groups

  [[nodiscard]] WireType type() const OSTEON_RT { return static_cast<WireType>(tag_ & 7u); }
  // Checks that the present field has this wire type; otherwise fails.
  bool Expect(WireType type) OSTEON_RT;
  // These functions read a value without a check of the field's wire type.
  std::uint64_t Varint() OSTEON_RT;
  std::uint32_t TagOrLength() OSTEON_RT;
  std::uint32_t EnumValue() OSTEON_RT;
  double Fixed64() OSTEON_RT;
  void AppendDoubles(double* to, std::size_t room, std::size_t& count) OSTEON_RT;
  void AppendEnums(std::uint32_t* to, std::size_t room, std::size_t& count) OSTEON_RT;
  [[nodiscard]] std::size_t left() const OSTEON_RT { return static_cast<std::size_t>(end_ - at_); }

  const std::uint8_t *at_, *end_;
  std::uint32_t tag_{0};
  bool ok_{true};
};

}  // namespace osteon::io
