#include "io/fri/command_reader.h"

#include <bit>

#include "io/fri/frame.h"

namespace osteon::io {
namespace {

constexpr std::size_t kMaxDatagram = 1500;     // [bytes]
constexpr std::uint32_t kCommandId = 0x34001;  // message identifier in the header of a command
// Protobuf's wire types.
constexpr std::uint32_t kVarint = 0, kFixed64 = 1, kBytes = 2;

using Bytes = std::span<const std::uint8_t>;

/// Reads protobuf fields one after the other. After the first malformed byte `good` stays false.
class Fields {
 public:
  explicit Fields(Bytes bytes) : rest_(bytes) {}

  [[nodiscard]] bool good() const { return good_; }
  /// Reads the next field's number and wire type; returns false at the end.
  bool Next(std::uint32_t& number, std::uint32_t& type) OSTEON_RT {
    if (!good_ || rest_.empty()) return false;
    const std::uint64_t key = Varint();
    number = static_cast<std::uint32_t>(key >> 3);
    type = static_cast<std::uint32_t>(key & 7);
    good_ &= key <= UINT32_MAX && number > 0;
    return good_;
  }
  // Varint, Double and Part read the value of the present field.
  std::uint64_t Varint() OSTEON_RT {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const std::uint8_t byte = rest_.front();
      rest_ = rest_.subspan(1);
      value |= std::uint64_t{byte & 0x7fu} << shift;
      if (byte < 0x80) return value;
    }
    good_ = false;
    return 0;
  }
  double Double() OSTEON_RT {
    if (rest_.size() < 8) {
      good_ = false;
      return 0.0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 8; i-- > 0;) bits = bits << 8 | rest_[i];
    rest_ = rest_.subspan(8);
    return std::bit_cast<double>(bits);
  }
  // Reads a value with a length (string, bytes, nested message or packed numbers), and returns its bytes.
  Bytes Part() OSTEON_RT {
    const std::uint64_t size = Varint();
    if (!good_ || size > rest_.size()) {
      good_ = false;
      return {};
    }
    const Bytes part = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(part.size());
    return part;
  }

 private:
  Bytes rest_;
  bool good_{true};
};

/// Records the field numbers read so far, to refuse repeated fields.
class SeenFields {
 public:
  // Records a field; returns false if it was recorded before.
  bool operator()(std::uint32_t number) OSTEON_RT {
    const std::uint32_t bit = number < 32 ? 1u << number : 0u;
    const bool first = bit != 0 && (seen_ & bit) == 0;
    seen_ |= bit;
    return first;
  }
  [[nodiscard]] bool Has(std::uint32_t number) const OSTEON_RT { return (seen_ >> number & 1u) != 0; }

 private:
  std::uint32_t seen_{0};
};

// Reads a message with exactly N doubles in field 1, packed or not. Returns false if it contains anything
// else.
template <std::size_t N>
bool ReadDoubles(Bytes bytes, std::optional<std::array<double, N>>& values) OSTEON_RT {
  std::array<double, N> read{};
  std::size_t count = 0;
  Fields fields(bytes);
  const auto put = [&](Fields& from) {
    const double value = from.Double();
    if (count < N) read[count] = value;
    ++count;
  };
  for (std::uint32_t number = 0, type = 0; fields.Next(number, type);) {
    if (number != 1 || (type != kFixed64 && type != kBytes)) return false;
    if (type == kFixed64) {
      put(fields);
      continue;
    }
    const Bytes part = fields.Part();
    if (part.size() % 8 != 0) return false;
    Fields packed(part);
    for (std::size_t left = part.size() / 8; left > 0; --left) put(packed);
  }
  if (!fields.good() || count != N) return false;
  values = read;
  return true;
}

// Reads the header: identifier (1), sequence (2) and reflected sequence (3), all required.
bool ReadHeader(Bytes bytes, FriReadCommand& command) OSTEON_RT {
  Fields fields(bytes);
  SeenFields seen;
  std::uint64_t id = 0, sequence = 0, reflected = 0;
  for (std::uint32_t number = 0, type = 0; fields.Next(number, type);) {
    if (type != kVarint || number > 3 || !seen(number)) return false;
    (number == 1 ? id : number == 2 ? sequence : reflected) = fields.Varint();
  }
  command.sequence = static_cast<std::uint32_t>(sequence);
  command.reflected_sequence = static_cast<std::uint32_t>(reflected);
  return fields.good() && seen.Has(1) && seen.Has(2) && seen.Has(3) && id == kCommandId &&
         sequence <= UINT32_MAX && reflected <= UINT32_MAX;
}

// Reads the command's data: joints (1), wrench (2), torques (3), pose (6) and redundancy (7). Frames and
// outputs for the robot's program (4, 5) are skipped and may be repeated, because they move no joint.
bool ReadData(FriFamily family, Bytes bytes, FriReadCommand& command) OSTEON_RT {
  Fields fields(bytes);
  SeenFields seen;
  for (std::uint32_t number = 0, type = 0; fields.Next(number, type);) {
    if (type != kBytes) return false;
    if (number != 4 && number != 5 && !seen(number)) return false;
    const Bytes part = fields.Part();
    switch (number) {
      case 1:
        if (!ReadDoubles(part, command.q)) return false;
        break;
      case 2:
        if (!ReadDoubles(part, command.wrench)) return false;
        break;
      case 3:
        if (!ReadDoubles(part, command.tau)) return false;
        break;
      case 4:
      case 5:
        break;
      case 6:
      case 7:
        if (family == FriFamily::k1) return false;
        command.cartesian = true;
        break;
      default:
        return false;
    }
  }
  return fields.good();
}

}  // namespace

FriCommandError ReadCommand(FriFamily family, Bytes datagram, FriReadCommand& command) OSTEON_RT {
  if (datagram.size() > kMaxDatagram) return FriCommandError::kMalformed;
  Bytes body = datagram;
  if (family == FriFamily::k2_7) {
    const FrameError frame = Unframe(datagram, body);
    if (frame == FrameError::kChecksum) return FriCommandError::kChecksum;
    if (frame != FrameError::kNone) return FriCommandError::kMalformed;
  }
  FriReadCommand read;
  Fields fields(body);
  SeenFields seen;
  // fields of a command: header (1), data (2), and before 2.7 its end (15)
  for (std::uint32_t number = 0, type = 0; fields.Next(number, type);) {
    if (type != kBytes || !seen(number)) return FriCommandError::kMalformed;
    const Bytes part = fields.Part();
    const bool known = number == 1   ? ReadHeader(part, read)
                       : number == 2 ? ReadData(family, part, read)
                                     : number == 15 && family != FriFamily::k2_7;
    if (!known) return FriCommandError::kMalformed;
  }
  if (!fields.good() || !seen.Has(1)) return FriCommandError::kMalformed;
  command = read;
  return FriCommandError::kNone;
}

}  // namespace osteon::io
