#include "io/fri/codec.h"

#include <algorithm>

#include "io/fri/frame.h"
#include "io/fri/wire_check.h"
#include "io/fri/wire_command.h"
#include "io/fri/wire_message.h"

namespace osteon::io {
namespace {

using control::CommandMode;
using control::SessionState;

// Largest send period [ms] and largest receive multiplier that FRI allows.
constexpr std::uint32_t kMaxPeriodMs = 100, kMaxMultiplier = 100;

// Finds the bare message (without a frame) inside a datagram of the family.
CodecError Open(FriFamily family, std::span<const std::uint8_t> datagram,
                std::span<const std::uint8_t>& body) OSTEON_RT {
  if (datagram.size() > kFriMaxDatagram) return CodecError::kTooLong;
  body = datagram;
  if (family != FriFamily::k2_7) return CodecError::kNone;
  switch (Unframe(datagram, body)) {
    case FrameError::kNone:
      return CodecError::kNone;
    case FrameError::kChecksum:
      return CodecError::kChecksum;
    case FrameError::kNotFramed:
      break;
  }
  return CodecError::kMalformed;
}

// Reads a bare monitoring message, and checks its identifier. @param[out] wire  must be default-constructed
CodecError Parse(std::span<const std::uint8_t> body, WireMonitoring& wire) OSTEON_RT {
  if (!ReadMonitoring(body, wire)) return CodecError::kMalformed;
  return wire.header.id == kFriMonitoringId ? CodecError::kNone : CodecError::kWrongId;
}

// Detects the family by fields that no other family has; empty for a bare message without such fields.
std::optional<FriFamily> FamilyOfFields(const WireMonitoring& wire) OSTEON_RT {
  if (wire.monitor.pose || wire.monitor.redundancy || wire.ipo.pose || wire.ipo.redundancy)
    return FriFamily::k2_5;
  if (wire.monitor.q_cmd) return FriFamily::k1;
  return std::nullopt;
}

}  // namespace

const char* Describe(CodecError error) {
  switch (error) {
    case CodecError::kNone:
      return "no error";
    case CodecError::kTooLong:
      return "datagram longer than 1500 bytes";
    case CodecError::kMalformed:
      return "not a message of this version";
    case CodecError::kWrongId:
      return "wrong message identifier";
    case CodecError::kMissingField:
      return "a field that this session state needs is missing";
    case CodecError::kWrongCount:
      return "not exactly 7 joint values or drive states, or a matrix or quaternion of another size";
    case CodecError::kNotFinite:
      return "a value is NaN or infinite";
    case CodecError::kOutOfRange:
      return "an enum, period, multiplier or rotation is out of range";
    case CodecError::kNoSpace:
      return "buffer too small";
    case CodecError::kChecksum:
      return "the frame's CRC-32 is not that of its message";
    case CodecError::kOtherVersion:
      return "a message of another FRI version";
  }
  return "unknown error";
}

std::optional<FriFamily> DetectFamily(std::span<const std::uint8_t> datagram) OSTEON_RT {
  WireMonitoring framed;
  std::span<const std::uint8_t> body;
  if (Open(FriFamily::k2_7, datagram, body) == CodecError::kNone && Parse(body, framed) == CodecError::kNone)
    return FriFamily::k2_7;
  WireMonitoring bare;
  if (datagram.size() > kFriMaxDatagram || Parse(datagram, bare) != CodecError::kNone) return std::nullopt;
  return FamilyOfFields(bare);
}

namespace {

// Removes a datagram's frame, if the family has one, and parses the message. Returns kOtherVersion for a
// datagram of another family.
CodecError ReadWire(FriFamily family, std::span<const std::uint8_t> datagram,
                    WireMonitoring& wire) OSTEON_RT {
  std::span<const std::uint8_t> body;
  CodecError parsed = Open(family, datagram, body);
  if (parsed == CodecError::kNone) parsed = Parse(body, wire);
  if (parsed == CodecError::kMalformed || parsed == CodecError::kWrongId)
    return DetectFamily(datagram).value_or(family) != family ? CodecError::kOtherVersion : parsed;
  if (parsed != CodecError::kNone) return parsed;
  const FriFamily bare = family == FriFamily::k2_7 ? FriFamily::k2_5 : family;
  if (FamilyOfFields(wire).value_or(bare) != bare) return CodecError::kOtherVersion;
  return wire.connection ? CodecError::kNone : CodecError::kMissingField;
}

}  // namespace

std::optional<control::JointArray> JointsNotFinite(FriFamily family,
                                                   std::span<const std::uint8_t> datagram) OSTEON_RT {
  WireMonitoring wire;
  if (ReadWire(family, datagram, wire) != CodecError::kNone) return std::nullopt;
  const auto& q = wire.monitor.q_meas;
  if (!q || q->count != q->value.size() || AllFinite(q->value)) return std::nullopt;
  return q->value;
}

CodecError DecodeMonitoring(FriFamily family, std::span<const std::uint8_t> datagram,
                            MonitoringMessage& message) OSTEON_RT {
  WireMonitoring wire;
  if (const CodecError error = ReadWire(family, datagram, wire); error != CodecError::kNone) return error;

  WireCheck check;
  MonitoringMessage m;
  m.sequence = *wire.header.sequence;
  m.reflected_sequence = *wire.header.reflected;

  // connection
  const WireConnection& connection = *wire.connection;
  check.ReadEnum(connection.session, SessionState::kCommandingActive, m.session);
  check.ReadEnum(connection.quality, FriQuality::kExcellent, m.quality);
  m.send_period_ms = connection.period_ms.value_or(m.send_period_ms);
  m.receive_multiplier = connection.multiplier.value_or(m.receive_multiplier);
  if (m.send_period_ms < 1 || m.send_period_ms > kMaxPeriodMs || m.receive_multiplier < 1 ||
      m.receive_multiplier > kMaxMultiplier)
    check.Fail(CodecError::kOutOfRange);

  // robot
  const WireRobot& robot = wire.robot;
  if (robot.joints.value_or(control::kJoints) != control::kJoints) check.Fail(CodecError::kWrongCount);
  check.ReadEnum(robot.safety, FriSafetyState::kStopLevel2, m.safety);
  check.ReadEnum(robot.operation, FriOperationMode::kAutomatic, m.operation);
  check.ReadEnum(robot.control, control::ControlMode::kNone, m.control);
  if (robot.drives.count != 0 && robot.drives.count != m.drives.size()) check.Fail(CodecError::kWrongCount);
  for (std::size_t i = 0; i < robot.drives.count; ++i)
    check.ReadEnum(robot.drives.value[i], FriDriveState::kActive, m.drives[i]);

  // measured and commanded
  const WireMonitor& monitor = wire.monitor;
  check.ReadVector(monitor.q_meas, m.q_meas);
  check.ReadVector(monitor.tau_meas, m.tau_meas);
  check.ReadVector(monitor.q_cmd, m.q_cmd);
  check.ReadVector(monitor.tau_cmd, m.tau_cmd);
  check.ReadVector(monitor.tau_ext, m.tau_ext);
  if (family == FriFamily::k2_7) check.ReadVector(monitor.force, m.wire_force);
  check.ReadPose(monitor.pose, monitor.redundancy, m.X_meas);
  for (const WireIo& io : monitor.ios) check.ReadIo(io, m.ios);
  m.time = ReadTime(monitor.time);

  // interpolator
  const WireIpo& ipo = wire.ipo;
  check.ReadVector(ipo.q, m.q_ipo);
  check.ReadPose(ipo.pose, ipo.redundancy, m.X_ipo);
  check.ReadEnum(ipo.command_mode,
                 family == FriFamily::k1 ? CommandMode::kTorque : CommandMode::kCartesianPose,
                 m.command_mode);
  check.ReadEnum(ipo.overlay, FriOverlay::kCartesian, m.overlay);
  m.tracking_performance = ipo.tracking.value_or(0.0);
  check.CheckFinite(m.tracking_performance);
  for (const WireTransformation& transformation : wire.transformations)
    check.ReadTransformation(family, transformation, m.transformations);

  // fields that the session state requires
  const bool commanding = m.session >= SessionState::kCommandingWait;
  if ((m.session != SessionState::kIdle && !m.q_meas) || (commanding && !m.q_ipo))
    check.Fail(CodecError::kMissingField);

  if (check.error() == CodecError::kNone) message = m;
  return check.error();
}

bool IsMonitoringMessage(FriFamily family, std::span<const std::uint8_t> datagram) OSTEON_RT {
  MonitoringMessage message;
  return DecodeMonitoring(family, datagram, message) == CodecError::kNone;
}

CodecError EncodeCommand(FriFamily family, const CommandMessage& message, std::span<std::uint8_t> buffer,
                         std::size_t& size) OSTEON_RT {
  // if the family has a frame, leave space for the frame's head before the protobuf
  const bool framed = family == FriFamily::k2_7;
  const std::size_t head = framed ? kFriFrameHead : 0, frame_bytes = framed ? head + kFriFrameTail : 0;
  const std::size_t room = std::min(buffer.size(), kFriMaxDatagram);
  ProtoWriter out(room < frame_bytes ? std::span<std::uint8_t>() : buffer.subspan(head, room - frame_bytes));
  if (!WriteCommand(family, message, out)) return CodecError::kNotFinite;
  if (!out.ok()) return CodecError::kNoSpace;
  size = framed ? Frame(buffer, out.size()) : out.size();
  return CodecError::kNone;
}

}  // namespace osteon::io
