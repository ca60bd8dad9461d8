#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/marker.h"

// Writes a protobuf message into the caller's memory, field by field in the order of the calls. A nested
// message is written between BeginMessage and EndMessage. EndMessage writes the nested message's length into
// the byte that BeginMessage has reserved:
//
//     ProtoWriter out(buffer);
//     const std::size_t header = out.BeginMessage(1);
//     out.Varint(2, sequence);
//     out.EndMessage(header);
//     if (!out.ok()) …
//
// If the memory is too small, nothing more is written and ok() is false.

namespace osteon::io {

class ProtoWriter {
 public:
  explicit ProtoWriter(std::span<std::uint8_t> buffer) OSTEON_RT : buffer_(buffer) {}

  /// Writes an unsigned integer or an enum.
  void Varint(std::uint32_t number, std::uint64_t value) OSTEON_RT;
  void Double(std::uint32_t number, double value) OSTEON_RT;
  void Text(std::uint32_t number, std::string_view text) OSTEON_RT;
  /// Writes a repeated field with a separate tag for each value.
  void Unpacked(std::uint32_t number, std::span<const double> values) OSTEON_RT;
  /// Writes a repeated field with one tag for all values; nothing if there are no values.
  void Packed(std::uint32_t number, std::span<const double> values) OSTEON_RT;

  /// Begins a nested message. @returns the argument for EndMessage.
  [[nodiscard]] std::size_t BeginMessage(std::uint32_t number) OSTEON_RT;
  void EndMessage(std::size_t begin) OSTEON_RT;

  [[nodiscard]] bool ok() const OSTEON_RT { return ok_; }
  /// Number of bytes written.
  [[nodiscard]] std::size_t size() const OSTEON_RT { return size_; }

 private:
  /// Reserves the next bytes; returns null if the memory is too small.
  std::uint8_t* Reserve(std::size_t bytes) OSTEON_RT;
  void PutVarint(std::uint64_t value) OSTEON_RT;
  void PutBytes(const void* bytes, std::size_t size) OSTEON_RT;

  std::span<std::uint8_t> buffer_;
  std::size_t size_{0};
  bool ok_{true};
};

}  // namespace osteon::io
