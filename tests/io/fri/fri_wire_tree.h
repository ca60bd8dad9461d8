#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <vector>

// A protobuf message as a tree, read without a schema, so that a test can change it anywhere and write it
// back with correct lengths. If only bytes were changed, the parser would nearly always stop at the first
// wrong length.

namespace osteon::io::test {

/// A field of a message: its number, wire type and value.
struct WireNode {
  std::uint32_t number{0};
  unsigned type{0};                 ///< wire type
  std::vector<std::uint8_t> bytes;  ///< the value, without tag and length
  std::vector<WireNode> parts;      ///< in place of `bytes`: the fields of an embedded message (type 2)
};

/// Appends a number in protobuf's variable length, seven bits a byte.
inline void PutVarint(std::uint64_t value, std::vector<std::uint8_t>& to) {
  for (; value >= 0x80; value >>= 7) to.push_back(static_cast<std::uint8_t>(value | 0x80));
  to.push_back(static_cast<std::uint8_t>(value));
}

/// The message with these fields.
inline std::vector<std::uint8_t> WriteTree(const std::vector<WireNode>& nodes) {
  std::vector<std::uint8_t> bytes;
  for (const WireNode& node : nodes) {
    PutVarint(std::uint64_t{node.number} << 3 | node.type, bytes);
    const auto inside = node.parts.empty() ? node.bytes : WriteTree(node.parts);
    if (node.type == 2) PutVarint(inside.size(), bytes);
    bytes.insert(bytes.end(), inside.begin(), inside.end());
  }
  return bytes;
}

/// The fields of a message; nullopt if the bytes are no message. Text that looks like a message by chance is
/// read as one, which does no harm.
inline std::optional<std::vector<WireNode>> ReadTree(std::span<const std::uint8_t> bytes) {
  std::size_t at = 0;
  const auto varint = [&]() -> std::optional<std::uint64_t> {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && at < bytes.size(); shift += 7) {
      const std::uint64_t byte = bytes[at++];
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    return std::nullopt;
  };
  std::vector<WireNode> nodes;
  while (at < bytes.size()) {
    const auto tag = varint();
    if (!tag || *tag < 8) return std::nullopt;
    WireNode node{static_cast<std::uint32_t>(*tag >> 3), static_cast<unsigned>(*tag & 7), {}, {}};
    std::size_t size = node.type == 1 ? 8 : 4;
    std::size_t begin = at;
    if (node.type == 0) {
      if (!varint()) return std::nullopt;
      size = at - begin;
      at = begin;
    } else if (node.type == 2) {
      const auto length = varint();
      if (!length) return std::nullopt;
      size = *length;
      begin = at;
    } else if (node.type != 1 && node.type != 5) {
      return std::nullopt;
    }
    if (size > bytes.size() - at) return std::nullopt;
    const auto inside = bytes.subspan(begin, size);
    if (node.type == 2)
      if (auto parts = ReadTree(inside)) node.parts = std::move(*parts);
    if (node.parts.empty()) node.bytes.assign(inside.begin(), inside.end());
    nodes.push_back(std::move(node));
    at = begin + size;
  }
  return nodes;
}

/// Changes one place of a tree: a field is doubled, removed, moved, gets another type or number, a hostile
/// value, or is cut in two; or an unknown field is inserted.
class TreeMutator {
 public:
  explicit TreeMutator(unsigned seed) : random_(seed) {}
  /// A random number from 0 to n - 1.
  std::size_t Below(std::size_t n) { return random_() % n; }

  void Change(std::vector<WireNode>& nodes) {
    if (nodes.empty() || Below(12) == 0) return InsertField(nodes);
    const std::size_t at = Below(nodes.size());
    if (!nodes[at].parts.empty() && Below(5) != 0) return Change(nodes[at].parts);
    const auto here = nodes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (Below(8)) {
      case 0:
      case 1: {
        const WireNode copy = *here;
        nodes.insert(nodes.begin() + static_cast<std::ptrdiff_t>(Below(nodes.size() + 1)), copy);
        return;
      }
      case 2:
        nodes.erase(here);
        return;
      case 3:
        here->type = static_cast<unsigned>(Below(8));
        return;
      case 4:
        here->number = static_cast<std::uint32_t>(Below(18));
        return;
      case 5:
        return SplitOrTruncate(nodes, at);
      default:
        ReplaceValue(*here);
    }
  }

 private:
  std::vector<std::uint8_t> Noise(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(Below(256));
    return bytes;
  }

  // A number at the limit of some type or rule, sometimes encoded in more bytes than needed.
  std::vector<std::uint8_t> HostileVarint() {
    constexpr std::uint64_t kValues[]{
        0,           1,          2,          3,          4,           5,     7,           100,
        101,         0x7fffffff, 0x80000000, 0xffffffff, 0x100000000, ~0ull, ~0ull << 31, (~0ull << 31) - 1,
        0x100000007, 1ull << 63};
    std::vector<std::uint8_t> bytes;
    PutVarint(kValues[Below(std::size(kValues))], bytes);
    if (Below(4) != 0) return bytes;
    // the same number in up to nine more bytes; a varint may have ten
    for (std::size_t more = Below(10); more > 0; --more) {
      bytes.back() |= 0x80;
      bytes.push_back(0);
    }
    return bytes;
  }

  // Gives a field another value of the same wire type.
  void ReplaceValue(WireNode& node) {
    node.parts.clear();
    if (node.type == 0) {
      node.bytes = HostileVarint();
    } else if (node.type == 2) {  // names of 63 and 64 bytes, doubles of seven joints and eight
      constexpr std::size_t kSizes[]{0, 1, 7, 8, 48, 56, 63, 64, 65, 96, 104};
      node.bytes = Below(2) ? Noise(kSizes[Below(std::size(kSizes))])
                            : std::vector<std::uint8_t>(kSizes[Below(std::size(kSizes))], 0);
    } else if (node.bytes.size() == 8 && Below(2)) {
      node.bytes[6] = 0xf0, node.bytes[7] = 0x7f;  // an infinity or NaN
    } else {
      node.bytes = Noise(node.bytes.size());
    }
  }

  // Splits a message into two parts that must be merged; truncates a number or bytes.
  void SplitOrTruncate(std::vector<WireNode>& nodes, std::size_t at) {
    WireNode& node = nodes[at];
    if (node.parts.empty()) {
      node.bytes.resize(node.bytes.size() / 2);
      return;
    }
    WireNode rest = node;
    const auto cut = static_cast<std::ptrdiff_t>(Below(node.parts.size()));
    rest.parts.erase(rest.parts.begin(), rest.parts.begin() + cut);
    node.parts.erase(node.parts.begin() + cut, node.parts.end());
    nodes.insert(nodes.begin() + static_cast<std::ptrdiff_t>(at) + 1, rest);
  }

  // Inserts a field, mostly with a number that the schema does not have.
  void InsertField(std::vector<WireNode>& nodes) {
    constexpr unsigned kTypes[]{0, 1, 2, 5, 0, 1, 2, 5, 3, 4};
    constexpr std::uint32_t kNumbers[]{11, 14, 16, 17, 1000, (1u << 29) - 1, 0, 7};
    WireNode node{kNumbers[Below(std::size(kNumbers))], kTypes[Below(std::size(kTypes))], {}, {}};
    if (node.type == 0) node.bytes = HostileVarint();
    if (node.type == 1) node.bytes = Noise(8);
    if (node.type == 2) node.bytes = Noise(Below(20));
    if (node.type == 5) node.bytes = Noise(4);
    if (node.type == 3) PutVarint(std::uint64_t{node.number} << 3 | 4, node.bytes);  // empty group
    nodes.insert(nodes.begin() + static_cast<std::ptrdiff_t>(Below(nodes.size() + 1)), node);
  }

  std::mt19937 random_;
};

}  // namespace osteon::io::test
