#include "io/fri/codec.h"

#include <pb_decode.h>
#include <pb_encode.h>

#include <algorithm>

#include "io/fri/frame.h"
#include "io/fri/wire_parts.h"

static_assert(kOsteonFriArraySize == osteon::control::kJoints);

// nanopb calls these for each unpacked element on the way in, and once for the whole field on the way out.
// The wire may legally pack what we write unpacked: nanopb then hands over the packed bytes until they are
// used up.

extern "C" bool osteon_fri_JointValues_callback(pb_istream_t* in, pb_ostream_t* out,
                                                const pb_field_t* field) {
  if (in != nullptr) {
    auto& joints = *static_cast<OsteonFriJoints*>(field->pData);
    if (joints.count >= kOsteonFriArraySize) return false;
    return pb_decode_fixed64(in, &joints.value[joints.count++]);
  }
  const auto& joints = *static_cast<const OsteonFriJoints*>(field->pData);
  for (std::uint32_t i = 0; i < joints.count; ++i)
    if (!pb_encode_tag_for_field(out, field) || !pb_encode_fixed64(out, &joints.value[i])) return false;
  return true;
}

// Ours never writes drive states: only the arm has drives.
extern "C" bool osteon_fri_RobotInfo_callback(pb_istream_t* in, pb_ostream_t* /*out*/,
                                              const pb_field_t* field) {
  if (in == nullptr) return false;
  auto& drives = *static_cast<OsteonFriDriveStates*>(field->pData);
  if (drives.count >= kOsteonFriArraySize) return false;
  return pb_decode_varint32(in, &drives.value[drives.count++]);
}

namespace osteon::io {
namespace {

using control::CommandMode;
using control::SessionState;

constexpr std::uint32_t kMaxPeriodMs = 100, kMaxMultiplier = 100;

// The bare message inside a datagram of the family.
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

// @param[out] wire  to be value-initialised: no field of the protocol has another default
CodecError Parse(std::span<const std::uint8_t> body, osteon_fri_FRIMonitoringMessage& wire) OSTEON_RT {
  pb_istream_t stream = pb_istream_from_buffer(body.data(), body.size());
  if (!pb_decode_ex(&stream, osteon_fri_FRIMonitoringMessage_fields, &wire, PB_DECODE_NOINIT))
    return CodecError::kMalformed;
  return wire.header.messageIdentifier == kFriMonitoringId ? CodecError::kNone : CodecError::kWrongId;
}

// By the fields that no other family has; a bare message without them is of nobody.
std::optional<FriFamily> FamilyOfFields(const osteon_fri_FRIMonitoringMessage& wire) OSTEON_RT {
  const auto& monitor = wire.monitorData;
  if (monitor.has_measuredCartesianPose || monitor.has_measuredRedundancyInformation ||
      wire.ipoData.has_cartesianPose || wire.ipoData.has_redundancyInformation)
    return FriFamily::k2_5;
  if (monitor.has_commandedJointPosition) return FriFamily::k1;
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

std::optional<FriFamily> TellFamily(std::span<const std::uint8_t> datagram) OSTEON_RT {
  osteon_fri_FRIMonitoringMessage wire{};
  std::span<const std::uint8_t> body;
  if (Open(FriFamily::k2_7, datagram, body) == CodecError::kNone && Parse(body, wire) == CodecError::kNone)
    return FriFamily::k2_7;
  wire = {};
  if (datagram.size() > kFriMaxDatagram || Parse(datagram, wire) != CodecError::kNone) return std::nullopt;
  return FamilyOfFields(wire);
}

CodecError DecodeMonitoring(FriFamily family, std::span<const std::uint8_t> datagram,
                            MonitoringMessage& message) OSTEON_RT {
  // the bytes; where they make no sense, maybe they do to another version
  osteon_fri_FRIMonitoringMessage wire{};
  std::span<const std::uint8_t> body;
  CodecError parsed = Open(family, datagram, body);
  if (parsed == CodecError::kNone) parsed = Parse(body, wire);
  if (parsed == CodecError::kMalformed || parsed == CodecError::kWrongId)
    return TellFamily(datagram).value_or(family) != family ? CodecError::kOtherVersion : parsed;
  if (parsed != CodecError::kNone) return parsed;
  const FriFamily bare = family == FriFamily::k2_7 ? FriFamily::k2_5 : family;
  if (FamilyOfFields(wire).value_or(bare) != bare) return CodecError::kOtherVersion;
  if (!wire.has_connectionInfo) return CodecError::kMissingField;

  WireCheck check;
  MonitoringMessage m;
  m.sequence = wire.header.sequenceCounter;
  m.reflected_sequence = wire.header.reflectedSequenceCounter;

  // connection
  const auto& connection = wire.connectionInfo;
  check.Enum(true, connection.sessionState, SessionState::kCommandingActive, m.session);
  check.Enum(true, connection.quality, FriQuality::kExcellent, m.quality);
  if (connection.has_sendPeriod) m.send_period_ms = connection.sendPeriod;
  if (connection.has_receiveMultiplier) m.receive_multiplier = connection.receiveMultiplier;
  if (m.send_period_ms < 1 || m.send_period_ms > kMaxPeriodMs || m.receive_multiplier < 1 ||
      m.receive_multiplier > kMaxMultiplier)
    check.Fail(CodecError::kOutOfRange);

  // robot
  const auto& robot = wire.robotInfo;
  if (robot.has_numberOfJoints && robot.numberOfJoints != control::kJoints)
    check.Fail(CodecError::kWrongCount);
  check.Enum(robot.has_safetyState, robot.safetyState, FriSafetyState::kStopLevel2, m.safety);
  check.Enum(robot.has_operationMode, robot.operationMode, FriOperationMode::kAutomatic, m.operation);
  check.Enum(robot.has_controlMode, robot.controlMode, control::ControlMode::kNone, m.control);
  if (robot.driveState.count != 0 && robot.driveState.count != kOsteonFriArraySize)
    check.Fail(CodecError::kWrongCount);
  for (std::uint32_t i = 0; i < robot.driveState.count; ++i)
    check.Enum(true, robot.driveState.value[i], FriDriveState::kActive, m.drives[i]);

  // measured and commanded
  const auto& monitor = wire.monitorData;
  check.Joints(monitor.has_measuredJointPosition, monitor.measuredJointPosition, m.q_meas);
  check.Joints(monitor.has_measuredTorque, monitor.measuredTorque, m.tau_meas);
  check.Joints(monitor.has_commandedJointPosition, monitor.commandedJointPosition, m.q_cmd);
  check.Joints(monitor.has_commandedTorque, monitor.commandedTorque, m.tau_cmd);
  check.Joints(monitor.has_externalTorque, monitor.externalTorque, m.tau_ext);
  if (family == FriFamily::k2_7) check.Wrench(monitor.has_externalForce, monitor.externalForce, m.wire_force);
  check.Pose(monitor.has_measuredCartesianPose, monitor.measuredCartesianPose,
             monitor.has_measuredRedundancyInformation, monitor.measuredRedundancyInformation, m.X_meas);
  for (pb_size_t i = 0; i < monitor.readIORequest_count; ++i) check.Io(monitor.readIORequest[i], m.ios);
  if (monitor.has_timestamp) m.time = FriTime{monitor.timestamp.sec, monitor.timestamp.nanosec};

  // interpolator
  const auto& ipo = wire.ipoData;
  check.Joints(ipo.has_jointPosition, ipo.jointPosition, m.q_ipo);
  check.Pose(ipo.has_cartesianPose, ipo.cartesianPose, ipo.has_redundancyInformation,
             ipo.redundancyInformation, m.X_ipo);
  check.Enum(ipo.has_clientCommandMode, ipo.clientCommandMode,
             family == FriFamily::k1 ? CommandMode::kTorque : CommandMode::kCartesianPose, m.command_mode);
  check.Enum(ipo.has_overlayType, ipo.overlayType, FriOverlay::kCartesian, m.overlay);
  if (ipo.has_trackingPerformance) m.tracking_performance = ipo.trackingPerformance;
  check.Finite(m.tracking_performance);
  for (pb_size_t i = 0; i < wire.requestedTransformations_count; ++i)
    check.Transformation(family, wire.requestedTransformations[i], m.transformations);

  // what the session state promises
  const bool commanding = m.session >= SessionState::kCommandingWait;
  if ((m.session != SessionState::kIdle && !m.q_meas) || (commanding && !m.q_ipo))
    check.Fail(CodecError::kMissingField);

  if (check.error() == CodecError::kNone) message = m;
  return check.error();
}

CodecError EncodeCommand(FriFamily family, const CommandMessage& message, std::span<std::uint8_t> buffer,
                         std::size_t& size) OSTEON_RT {
  osteon_fri_FRICommandMessage wire{};
  wire.header = {kFriCommandId, message.sequence, message.reflected_sequence};
  auto& data = wire.commandData;
  bool finite = PutJoints(message.q, data.has_jointPosition, data.jointPosition);
  finite &=
      PutWrench(message.wire_wrench, data.has_cartesianWrenchFeedForward, data.cartesianWrenchFeedForward);
  finite &= PutJoints(message.tau, data.has_jointTorque, data.jointTorque);
  for (const FriTransformation& transformation : message.outputs.transformations)
    finite &= PutTransformation(family, transformation,
                                data.commandedTransformations[data.commandedTransformations_count++]);
  for (const FriIo& write : message.outputs.writes)
    finite &= PutIo(write, data.writeIORequest[data.writeIORequest_count++]);
  data.has_cartesianPose = message.X && family != FriFamily::k1;
  if (data.has_cartesianPose) {
    finite &= PutPose(*message.X, data.cartesianPose);
    data.has_redundancyInformation = message.X->redundancy.has_value();
    if (message.X->redundancy)
      data.redundancyInformation = {message.X->redundancy->strategy, message.X->redundancy->value};
  }
  if (!finite) return CodecError::kNotFinite;
  wire.has_commandData = data.has_jointPosition || data.has_cartesianWrenchFeedForward ||
                         data.has_jointTorque || data.has_cartesianPose ||
                         data.commandedTransformations_count > 0 || data.writeIORequest_count > 0;

  // the protobuf, at its place within the frame
  const bool framed = family == FriFamily::k2_7;
  const std::size_t head = framed ? kFriFrameHead : 0, around = framed ? head + kFriFrameTail : 0;
  const std::size_t room = std::min(buffer.size(), kFriMaxDatagram);
  if (room < around) return CodecError::kNoSpace;
  pb_ostream_t stream = pb_ostream_from_buffer(buffer.data() + head, room - around);
  if (!pb_encode(&stream, osteon_fri_FRICommandMessage_fields, &wire)) return CodecError::kNoSpace;
  size = framed ? Frame(buffer, stream.bytes_written) : stream.bytes_written;
  return CodecError::kNone;
}

}  // namespace osteon::io
