#include "io/fri/proto_writer.h"

#include <bit>
#include <cstring>

namespace osteon::io {
namespace {

constexpr std::uint32_t kVarint = 0, kFixed64 = 1, kBytes = 2;  // wire types

static_assert(std::endian::native == std::endian::little, "doubles are copied as they lie on the wire");

// The tag that precedes a field's value.
constexpr std::uint64_t Tag(std::uint32_t number, std::uint32_t type) OSTEON_RT {
  return std::uint64_t{number} << 3 | type;
}

// Number of bytes of the value as a varint.
std::size_t VarintSize(std::uint64_t value) OSTEON_RT {
  std::size_t size = 1;
  for (; value >= 0x80; value >>= 7) ++size;
  return size;
}

}  // namespace

std::uint8_t* ProtoWriter::Reserve(std::size_t bytes) OSTEON_RT {
  ok_ = ok_ && bytes <= buffer_.size() - size_;
  if (!ok_) return nullptr;
  std::uint8_t* at = buffer_.data() + size_;
  size_ += bytes;
  return at;
}

void ProtoWriter::PutVarint(std::uint64_t value) OSTEON_RT {
  std::uint8_t* to = Reserve(VarintSize(value));
  if (to == nullptr) return;
  for (; value >= 0x80; value >>= 7) *to++ = static_cast<std::uint8_t>(value | 0x80);
  *to = static_cast<std::uint8_t>(value);
}

void ProtoWriter::PutBytes(const void* bytes, std::size_t size) OSTEON_RT {
  std::uint8_t* to = Reserve(size);
  if (to != nullptr && size != 0) std::memcpy(to, bytes, size);
}

void ProtoWriter::Varint(std::uint32_t number, std::uint64_t value) OSTEON_RT {
  PutVarint(Tag(number, kVarint));
  PutVarint(value);
}

void ProtoWriter::Double(std::uint32_t number, double value) OSTEON_RT {
  PutVarint(Tag(number, kFixed64));
  PutBytes(&value, sizeof value);
}

void ProtoWriter::Text(std::uint32_t number, std::string_view text) OSTEON_RT {
  PutVarint(Tag(number, kBytes));
  PutVarint(text.size());
  PutBytes(text.data(), text.size());
}

void ProtoWriter::Unpacked(std::uint32_t number, std::span<const double> values) OSTEON_RT {
  for (const double value : values) Double(number, value);
}

void ProtoWriter::Packed(std::uint32_t number, std::span<const double> values) OSTEON_RT {
  if (values.empty()) return;
  PutVarint(Tag(number, kBytes));
  PutVarint(values.size_bytes());
  PutBytes(values.data(), values.size_bytes());
}

std::size_t ProtoWriter::BeginMessage(std::uint32_t number) OSTEON_RT {
  PutVarint(Tag(number, kBytes));
  (void)Reserve(1);
  return size_;
}

void ProtoWriter::EndMessage(std::size_t begin) OSTEON_RT {
  if (!ok_) return;
  // a length of more than 127 needs more than the one byte that BeginMessage has reserved
  std::uint64_t length = size_ - begin;
  const std::size_t more = VarintSize(length) - 1;
  if (Reserve(more) == nullptr) return;
  std::uint8_t* to = buffer_.data() + begin;
  if (more != 0) std::memmove(to + more, to, static_cast<std::size_t>(length));
  for (--to; length >= 0x80; length >>= 7) *to++ = static_cast<std::uint8_t>(length | 0x80);
  *to = static_cast<std::uint8_t>(length);
}

}  // namespace osteon::io
