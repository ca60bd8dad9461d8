#include "io/engine/codec.h"

#include <cmath>

#include <zlib.h>

#include "io/engine/byte_cursor.h"

namespace osteon::io {
namespace {

constexpr std::size_t kCrcAt = 12;  // position of the CRC-32 in the header
constexpr double kMaxValue = 1e9;   // bound on every number's magnitude, in SI units: far beyond any cell
// Largest difference between an element of R R^T and that of the identity.
constexpr double kMaxRotationError = 1e-6;
constexpr double kMaxDt_s = 1.0;  // largest EngineCommand::dt_s

// CRC-32 of a message, computed without the four bytes of the CRC-32 itself.
std::uint32_t Checksum(std::span<const std::uint8_t> message) OSTEON_RT {
  const uLong first = crc32_z(0, message.data(), kCrcAt);
  const std::span<const std::uint8_t> rest = message.subspan(kCrcAt + sizeof(std::uint32_t));
  return static_cast<std::uint32_t>(crc32_z(first, rest.data(), rest.size()));
}

bool IsAccepted(double value) OSTEON_RT { return std::abs(value) <= kMaxValue; }  // false for NaN

// Whether R (row-major) is a rotation; false for NaN.
bool IsRotation(const std::array<double, 9>& R) OSTEON_RT {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      double dot = 0.0;
      for (std::size_t k = 0; k < 3; ++k) dot += R[3 * i + k] * R[3 * j + k];
      if (!(std::abs(dot - (i == j ? 1.0 : 0.0)) <= kMaxRotationError)) return false;
    }
  }
  const double det = R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) +
                     R[2] * (R[3] * R[7] - R[4] * R[6]);
  return det > 0.0;
}

// Encoding and decoding use the same list of a message's fields (Visit), so they cannot differ. Visit calls
// Field for each value: FieldReader reads and checks the value, FieldWriter writes it. Require checks a
// condition on several values when reading.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> content) : reader_(content) {}

  template <class T>
  void Field(T& value) OSTEON_RT {
    reader_.Get(value);
    if constexpr (std::is_floating_point_v<T>) accepted_ &= IsAccepted(value);
  }
  void Require(bool holds) OSTEON_RT { accepted_ &= holds; }
  [[nodiscard]] bool accepted() const OSTEON_RT { return accepted_ && reader_.ok() && reader_.left() == 0; }

 private:
  ByteReader reader_;
  bool accepted_{true};
};

class FieldWriter {
 public:
  explicit FieldWriter(std::span<std::uint8_t> room) : writer_(room) {}
  template <class T>
  void Field(T& value) OSTEON_RT {
    writer_.Put(value);
  }
  void Require(bool) OSTEON_RT {}
  [[nodiscard]] const ByteWriter& writer() const OSTEON_RT { return writer_; }

 private:
  ByteWriter writer_;
};

template <class Fields>
void Visit(Fields& fields, PlainVector3& v) OSTEON_RT {
  fields.Field(v.x);
  fields.Field(v.y);
  fields.Field(v.z);
}

template <class Fields>
void Visit(Fields& fields, PlainPose& X) OSTEON_RT {
  for (double& element : X.R) fields.Field(element);
  Visit(fields, X.p);
  fields.Require(IsRotation(X.R));
}

template <class Fields>
void Visit(Fields& fields, simulation::Contact& c) OSTEON_RT {
  Visit(fields, c.p_TP_m);
  Visit(fields, c.p_W_m);
  Visit(fields, c.n_W);
  for (double* value : {&c.gap_m, &c.stiffness_N_per_m, &c.mu, &c.advance_m_per_s, &c.weight})
    fields.Field(*value);
  fields.Field(c.material);
  fields.Require(c.material < simulation::kMaxMaterials && c.stiffness_N_per_m >= 0.0 && c.mu >= 0.0);
}

template <class Fields>
void Visit(Fields& fields, EngineCommand& c) OSTEON_RT {
  Visit(fields, c.command.X_WT);
  fields.Field(c.command.spindle_rad_per_s);
  fields.Field(c.command.stamp);
  fields.Field(c.dt_s);
  fields.Require(c.command.stamp > 0 && std::abs(c.dt_s) <= kMaxDt_s);
}

template <class Fields>
void Visit(Fields& fields, EngineFrame& f) OSTEON_RT {
  simulation::ContactModel& m = f.model;
  fields.Field(m.contact_count);
  fields.Field(m.status);
  const bool counted = m.contact_count >= 0 && m.contact_count <= simulation::kMaxContacts;
  fields.Require(counted && m.status <= simulation::EngineStatus::kOverloaded);
  for (std::int32_t i = 0; counted && i < m.contact_count; ++i)
    Visit(fields, m.contacts[static_cast<std::size_t>(i)]);
  Visit(fields, m.X_WP);
  Visit(fields, m.n_W);
  fields.Field(m.contact_fraction);
  Visit(fields, m.p_WS_m);
  Visit(fields, m.F_T_W.f);
  Visit(fields, m.F_T_W.t);
  for (double* value : {&m.advance_m_per_s, &m.engaged_area_m2, &m.spindle_torque_Nm, &m.removed_volume_m3,
                        &m.removed_mass_kg, &m.cutting_work_J, &f.spindle_rad_per_s})
    fields.Field(*value);
  fields.Field(m.balls_not_split);
  fields.Field(m.pose_stamp);
  fields.Field(m.frame);
  fields.Field(f.duration_ns);
  fields.Require(m.pose_stamp >= 0 && f.duration_ns >= 0);
}

// Encodes a command or a frame as a complete message.
template <class Message>
void EncodeFields(const EngineHeader& header, const Message& message, EngineBytes& out) OSTEON_RT {
  std::array<std::uint8_t, kEngineMaxMessage - kEngineHeaderBytes> content;
  FieldWriter fields(content);
  Message copy = message;  // Visit needs a non-const message, because it also decodes
  Visit(fields, copy);
  EncodeEngine(header, {content.data(), fields.writer().size()}, out);
}

// Decodes a complete message of one kind. In case of an error `out` is not changed.
template <class Message>
EngineError DecodeFields(EngineMessage kind, std::span<const std::uint8_t> bytes, EngineHeader& header,
                         Message& out) OSTEON_RT {
  std::span<const std::uint8_t> content;
  if (const EngineError error = DecodeEngine(bytes, header, content); error != EngineError::kNone)
    return error;
  if (header.kind != kind) return EngineError::kWrongKind;
  FieldReader fields(content);
  Message message;
  Visit(fields, message);
  if (!fields.accepted()) return EngineError::kOutOfRange;
  out = message;
  return EngineError::kNone;
}

}  // namespace

const char* Describe(EngineError error) {
  switch (error) {
    case EngineError::kNone:
      return "no error";
    case EngineError::kWrongSize:
      return "not as long as it says, or longer than 1472 bytes";
    case EngineError::kNotOurs:
      return "no message of an engine";
    case EngineError::kOtherVersion:
      return "a message of another version of the engine's protocol";
    case EngineError::kChecksum:
      return "the CRC-32 is not that of the message";
    case EngineError::kWrongKind:
      return "another kind of message";
    case EngineError::kOutOfRange:
      return "a number is not finite or out of range, or the content has another length";
  }
  return "unknown error";
}

bool EncodeEngine(const EngineHeader& header, std::span<const std::uint8_t> content,
                  EngineBytes& message) OSTEON_RT {
  message.size = 0;
  if (content.size() > kEngineMaxMessage - kEngineHeaderBytes) return false;
  const std::size_t size = kEngineHeaderBytes + content.size();
  ByteWriter writer(message.bytes);
  writer.Put(kEngineMagic);
  writer.Put(kEngineVersion);
  writer.Put(header.kind);
  writer.Put(static_cast<std::uint32_t>(size));
  writer.Put(std::uint32_t{0});
  writer.Put(header.session);
  writer.Put(header.sequence);
  writer.PutBytes(content);
  message.size = size;
  const std::uint32_t crc = Checksum(message.view());
  std::memcpy(message.bytes.data() + kCrcAt, &crc, sizeof crc);
  return true;
}

void EncodeEngine(const EngineHeader& header, const EngineCommand& command, EngineBytes& message) OSTEON_RT {
  EncodeFields(header, command, message);
}

void EncodeEngine(const EngineHeader& header, const EngineFrame& frame, EngineBytes& message) OSTEON_RT {
  EncodeFields(header, frame, message);
}

EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                         std::span<const std::uint8_t>& content) OSTEON_RT {
  if (message.size() < kEngineHeaderBytes || message.size() > kEngineMaxMessage)
    return EngineError::kWrongSize;
  ByteReader reader(message);
  if (reader.Get<std::uint32_t>() != kEngineMagic) return EngineError::kNotOurs;
  if (reader.Get<std::uint16_t>() != kEngineVersion) return EngineError::kOtherVersion;
  const auto kind = reader.Get<std::uint16_t>();
  if (reader.Get<std::uint32_t>() != message.size()) return EngineError::kWrongSize;
  if (reader.Get<std::uint32_t>() != Checksum(message)) return EngineError::kChecksum;
  if (kind < static_cast<std::uint16_t>(EngineMessage::kHello) ||
      kind > static_cast<std::uint16_t>(EngineMessage::kGoodbye))
    return EngineError::kWrongKind;
  header.kind = static_cast<EngineMessage>(kind);
  reader.Get(header.session);
  reader.Get(header.sequence);
  content = message.subspan(kEngineHeaderBytes);
  return EngineError::kNone;
}

EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                         EngineCommand& command) OSTEON_RT {
  return DecodeFields(EngineMessage::kCommand, message, header, command);
}

EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                         EngineFrame& frame) OSTEON_RT {
  return DecodeFields(EngineMessage::kFrame, message, header, frame);
}

}  // namespace osteon::io
