#include "io/fri/proto_reader.h"

#include <bit>
#include <cstring>
#include <limits>

namespace osteon::io {
namespace {

constexpr std::uint64_t kMax32 = std::numeric_limits<std::uint32_t>::max();
constexpr std::ptrdiff_t kMaxBytes32 = 5;  // largest size of a varint of 32 bits

static_assert(std::endian::native == std::endian::little, "doubles are copied as they lie on the wire");

}  // namespace

bool ProtoReader::Next() OSTEON_RT {
  if (at_ == end_) return false;
  tag_ = TagOrLength();
  if (number() == 0) Fail();
  return ok_;
}

bool ProtoReader::Expect(WireType expected) OSTEON_RT {
  if (type() != expected) Fail();
  return ok_;
}

std::uint64_t ProtoReader::Varint() OSTEON_RT {
  if (at_ != end_ && *at_ < 0x80) return *at_++;  // common case: one byte
  std::uint64_t value = 0;
  for (unsigned shift = 0; at_ != end_; shift += 7) {
    const std::uint64_t byte = *at_++;
    if (shift == 63 && byte > 1) break;  // the tenth byte may contain only the 64th bit
    value |= (byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  Fail();
  return 0;
}

std::uint32_t ProtoReader::TagOrLength() OSTEON_RT {
  const std::uint8_t* begin = at_;
  const std::uint64_t value = Varint();
  if (value > kMax32 || at_ - begin > kMaxBytes32) {
    Fail();
    return 0;
  }
  return static_cast<std::uint32_t>(value);
}

std::uint32_t ProtoReader::Uint32() OSTEON_RT {
  const std::uint64_t value = Uint64();
  if (value > kMax32) Fail();
  return ok_ ? static_cast<std::uint32_t>(value) : 0;
}

std::uint32_t ProtoReader::EnumValue() OSTEON_RT {
  const std::uint64_t value = Varint();
  // a negative enum value is encoded with its sign extended to 64 bits
  const auto narrow = static_cast<std::uint32_t>(value);
  const auto extended = static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(narrow)});
  if (value != narrow && value != extended) Fail();
  return ok_ ? narrow : 0;
}

double ProtoReader::Fixed64() OSTEON_RT {
  double value = 0.0;
  if (left() < sizeof value) {
    Fail();
    return 0.0;
  }
  std::memcpy(&value, at_, sizeof value);
  at_ += sizeof value;
  return value;
}

std::span<const std::uint8_t> ProtoReader::Bytes() OSTEON_RT {
  if (!Expect(kBytes)) return {};
  const std::size_t size = TagOrLength();
  if (size > left()) Fail();
  if (!ok_) return {};
  const std::span<const std::uint8_t> bytes(at_, size);
  at_ += size;
  return bytes;
}

std::string_view ProtoReader::Text(std::size_t max_size) OSTEON_RT {
  const auto bytes = Bytes();
  if (bytes.size() > max_size) {
    Fail();
    return {};
  }
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void ProtoReader::Skip() OSTEON_RT {
  switch (type()) {
    case kVarint:
      (void)Varint();
      return;
    case kFixed64:
      (void)Fixed64();
      return;
    case kBytes:
      (void)Bytes();
      return;
    case kFixed32:
      if (left() < sizeof(std::uint32_t)) return Fail();
      at_ += sizeof(std::uint32_t);
      return;
  }
  Fail();
}

void ProtoReader::AppendDoubles(double* to, std::size_t room, std::size_t& count) OSTEON_RT {
  if (type() != kBytes) {
    const double value = Double();
    if (count == room) return Fail();
    to[count++] = value;
    // fast path: the further elements nearly always follow directly, each with the same one-byte tag
    for (; count < room && left() > sizeof value && *at_ == tag_; at_ += 1 + sizeof value)
      std::memcpy(to + count++, at_ + 1, sizeof value);
    return;
  }
  const auto packed = Bytes();
  const std::size_t more = packed.size() / sizeof(double);
  if (packed.size() % sizeof(double) != 0 || more > room - count) return Fail();
  if (more != 0) std::memcpy(to + count, packed.data(), packed.size());
  count += more;
}

void ProtoReader::AppendEnums(std::uint32_t* to, std::size_t room, std::size_t& count) OSTEON_RT {
  if (type() != kBytes) {
    const std::uint32_t value = Enum();
    if (count == room) return Fail();
    to[count++] = value;
    return;
  }
  ProtoReader packed(Bytes());
  while (packed.at_ != packed.end_) {
    if (count == room) return Fail();
    to[count++] = packed.EnumValue();
  }
  if (!packed.ok_) Fail();
}

}  // namespace osteon::io
