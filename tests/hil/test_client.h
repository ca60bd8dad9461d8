#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "control/ports.h"
#include "kinematics/lbr_arm.h"
#include "tests/kinematics/iiwa14.h"

// An FRI client for the tests. It encodes and decodes the protobuf messages byte by byte from the table of
// field numbers. It does not use the schema of the simulated arm's libprotobuf, so that it can check that
// schema.

namespace osteon::hil {

using Bytes = std::vector<std::uint8_t>;

// In protobuf's encoding, PutVarint appends a number; PutUint, PutBytes and PutDouble append a field.

inline void PutVarint(Bytes& out, std::uint64_t v) {
  for (; v >= 0x80; v >>= 7) out.push_back(static_cast<std::uint8_t>(v | 0x80));
  out.push_back(static_cast<std::uint8_t>(v));
}

inline void PutUint(Bytes& out, unsigned field, std::uint64_t v) {
  PutVarint(out, field << 3);
  PutVarint(out, v);
}

inline void PutBytes(Bytes& out, unsigned field, const Bytes& content) {
  PutVarint(out, field << 3 | 2);
  PutVarint(out, content.size());
  out.insert(out.end(), content.begin(), content.end());
}

inline void PutDouble(Bytes& out, unsigned field, double v) {
  PutVarint(out, field << 3 | 1);
  const auto bits = std::bit_cast<std::uint64_t>(v);
  for (int i = 0; i < 8; ++i) out.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

/// A command message with joint angles q [rad]; without joints if q is empty.
/// @param reflected  sequence number of the message that the command answers
/// @param id  message identifier
inline Bytes Command(std::uint32_t sequence, std::uint32_t reflected, const std::vector<double>& q,
                     std::uint32_t id = 0x34001) {
  Bytes header, message;
  PutUint(header, 1, id);
  PutUint(header, 2, sequence);
  PutUint(header, 3, reflected);
  PutBytes(message, 1, header);
  if (!q.empty()) {
    Bytes joints, data;
    for (const double v : q) PutDouble(joints, 1, v);
    PutBytes(data, 1, joints);
    PutBytes(message, 2, data);
  }
  return message;
}

/// One field of a protobuf message: its number and its wire type (0 varint, 1 fixed64, 2 length-delimited).
struct Field {
  unsigned number{0}, type{0};
  std::uint64_t value{0};                 // value of a varint or a fixed64
  std::span<const std::uint8_t> content;  // content of a length-delimited field
};

/// The fields of a message in their order; nullopt if the bytes are no protobuf message.
inline std::optional<std::vector<Field>> Fields(std::span<const std::uint8_t> bytes) {
  std::vector<Field> fields;
  std::size_t i = 0;
  const auto varint = [&]() -> std::optional<std::uint64_t> {
    std::uint64_t v = 0;
    for (int shift = 0; i < bytes.size() && shift < 64; shift += 7) {
      const std::uint8_t b = bytes[i++];
      v |= static_cast<std::uint64_t>(b & 0x7f) << shift;
      if (b < 0x80) return v;
    }
    return std::nullopt;
  };
  while (i < bytes.size()) {
    const auto tag = varint();
    if (!tag) return std::nullopt;
    Field field{
        .number = static_cast<unsigned>(*tag >> 3), .type = static_cast<unsigned>(*tag & 7), .content = {}};
    if (field.type == 1) {
      if (bytes.size() - i < 8) return std::nullopt;
      std::memcpy(&field.value, &bytes[i], 8);
      i += 8;
    } else {
      const auto v = varint();
      if (!v) return std::nullopt;
      field.value = *v;
      if (field.type == 2) {
        if (bytes.size() - i < *v) return std::nullopt;
        field.content = bytes.subspan(i, *v);
        i += *v;
      } else if (field.type != 0) {
        return std::nullopt;
      }
    }
    fields.push_back(field);
  }
  return fields;
}

/// All fields at a path of field numbers: {3, 1} gives all fields 1 within the message's first field 3. Empty
/// if there are none.
inline std::vector<Field> At(std::span<const std::uint8_t> message, std::initializer_list<unsigned> path) {
  std::vector<Field> found;
  std::span<const std::uint8_t> level = message;
  for (const unsigned number : path) {
    found.clear();
    const auto fields = Fields(level);
    if (!fields) return {};
    for (const Field& f : *fields)
      if (f.number == number) found.push_back(f);
    if (found.empty()) return {};
    level = found.front().content;
  }
  return found;
}

/// The first number at a path; if there is none, a number with all bits set.
inline std::uint64_t UintAt(std::span<const std::uint8_t> message, std::initializer_list<unsigned> path) {
  const auto found = At(message, path);
  return found.empty() ? ~0ull : found.front().value;
}

/// All doubles at a path.
inline std::vector<double> DoublesAt(std::span<const std::uint8_t> message,
                                     std::initializer_list<unsigned> path) {
  std::vector<double> values;
  for (const Field& f : At(message, path)) values.push_back(std::bit_cast<double>(f.value));
  return values;
}

/// A command message with joints, and with a wrench (six elements, packed) or torques (seven, unpacked).
/// Empty vectors are left out.
inline Bytes OverlayCommand(std::uint32_t sequence, std::uint32_t reflected, const std::vector<double>& q,
                            const std::vector<double>& wrench, const std::vector<double>& tau) {
  Bytes message = Command(sequence, reflected, {}), data, part;
  for (const double v : q) PutDouble(part, 1, v);
  if (!q.empty()) PutBytes(data, 1, part);
  Bytes packed, vector, torques;
  for (const double v : wrench) {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    for (int i = 0; i < 8; ++i) packed.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
  PutBytes(vector, 1, packed);
  if (!wrench.empty()) PutBytes(data, 2, vector);
  for (const double v : tau) PutDouble(torques, 1, v);
  if (!tau.empty()) PutBytes(data, 3, torques);
  PutBytes(message, 2, data);
  return message;
}

/// A client of FRI 1.15. It repeats the measured joints, or while commanding the interpolator's joints. In
/// COMMANDING_ACTIVE it adds `offset` [rad]. While commanding it also sends the wrench or the torques, if
/// they are set.
struct TestClient {
  std::uint32_t sequence{0};
  std::array<double, 7> offset{};
  std::vector<double> wrench{}, tau{};

  Bytes Answer(std::span<const std::uint8_t> message) {
    const auto state = static_cast<control::SessionState>(UintAt(message, {4, 1}));
    const bool commanding =
        state == control::SessionState::kCommandingWait || state == control::SessionState::kCommandingActive;
    std::vector<double> q = commanding ? DoublesAt(message, {5, 1, 1}) : DoublesAt(message, {3, 3, 1});
    if (state == control::SessionState::kCommandingActive)
      for (std::size_t i = 0; i < q.size(); ++i) q[i] += offset[i];
    const auto reflected = static_cast<std::uint32_t>(UintAt(message, {1, 2}));
    if (commanding && !(wrench.empty() && tau.empty()))
      return OverlayCommand(++sequence, reflected, q, wrench, tau);
    return Command(++sequence, reflected, q);
  }
};

}  // namespace osteon::hil
