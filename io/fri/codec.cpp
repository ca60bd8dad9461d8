#include "io/fri/codec.h"

#include <fri.pb.h>
#include <pb_decode.h>
#include <pb_encode.h>

#include <algorithm>
#include <cmath>

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

using control::JointArray;
using control::SessionState;

constexpr std::uint32_t kMaxPeriodMs = 100, kMaxMultiplier = 100;

// Fixed bound, early out: the first error found is the one reported.
class Check {
 public:
  [[nodiscard]] CodecError error() const OSTEON_RT { return error_; }
  void Fail(CodecError error) OSTEON_RT {
    if (error_ == CodecError::kNone) error_ = error;
  }

  void Finite(double value) OSTEON_RT {
    if (!std::isfinite(value)) Fail(CodecError::kNotFinite);
  }

  template <class E>
  void Enum(bool has, std::uint32_t wire, E largest, E& value) OSTEON_RT {
    if (!has) return;
    if (wire > static_cast<std::uint32_t>(largest)) return Fail(CodecError::kOutOfRange);
    value = static_cast<E>(wire);
  }

  void Joints(bool has, const osteon_fri_JointValues& wire, std::optional<JointArray>& value) OSTEON_RT {
    if (!has) return;
    if (wire.value.count != kOsteonFriArraySize) return Fail(CodecError::kWrongCount);
    JointArray& joints = value.emplace();
    std::copy(std::begin(wire.value.value), std::end(wire.value.value), joints.begin());
    for (const double joint : joints) Finite(joint);
  }

 private:
  CodecError error_{CodecError::kNone};
};

// Sets the wire's presence flag and array; false where a value is not finite.
bool PutJoints(const std::optional<JointArray>& value, bool& has, osteon_fri_JointValues& wire) OSTEON_RT {
  has = value.has_value();
  if (!has) return true;
  wire.value.count = kOsteonFriArraySize;
  std::copy(value->begin(), value->end(), std::begin(wire.value.value));
  return std::all_of(value->begin(), value->end(), [](double joint) { return std::isfinite(joint); });
}

CodecError Parse(std::span<const std::uint8_t> datagram, const pb_msgdesc_t* fields, void* wire) OSTEON_RT {
  if (datagram.size() > kFriMaxDatagram) return CodecError::kTooLong;
  pb_istream_t stream = pb_istream_from_buffer(datagram.data(), datagram.size());
  return pb_decode(&stream, fields, wire) ? CodecError::kNone : CodecError::kMalformed;
}

CodecError Write(const pb_msgdesc_t* fields, const void* wire, std::span<std::uint8_t> buffer,
                 std::size_t& size) OSTEON_RT {
  pb_ostream_t stream = pb_ostream_from_buffer(buffer.data(), std::min(buffer.size(), kFriMaxDatagram));
  if (!pb_encode(&stream, fields, wire)) return CodecError::kNoSpace;
  size = stream.bytes_written;
  return CodecError::kNone;
}

}  // namespace

const char* Describe(CodecError error) {
  switch (error) {
    case CodecError::kNone:
      return "no error";
    case CodecError::kTooLong:
      return "datagram longer than 1500 bytes";
    case CodecError::kMalformed:
      return "not a protobuf of this message";
    case CodecError::kWrongId:
      return "wrong message identifier";
    case CodecError::kMissingField:
      return "a field that this session state needs is missing";
    case CodecError::kWrongCount:
      return "not exactly 7 joint values or drive states";
    case CodecError::kNotFinite:
      return "a value is NaN or infinite";
    case CodecError::kOutOfRange:
      return "an enum, period or multiplier is out of range";
    case CodecError::kNoSpace:
      return "buffer too small";
  }
  return "unknown error";
}

CodecError DecodeMonitoring(std::span<const std::uint8_t> datagram, MonitoringMessage& message) OSTEON_RT {
  osteon_fri_FRIMonitoringMessage wire{};
  const CodecError parsed = Parse(datagram, osteon_fri_FRIMonitoringMessage_fields, &wire);
  if (parsed != CodecError::kNone) return parsed;
  if (wire.header.messageIdentifier != kFriMonitoringId) return CodecError::kWrongId;
  if (!wire.has_connectionInfo) return CodecError::kMissingField;

  Check check;
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
  check.Enum(robot.has_controlMode, robot.controlMode, FriControlMode::kNone, m.control);
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
  if (monitor.has_timestamp) m.time = FriTime{monitor.timestamp.sec, monitor.timestamp.nanosec};

  // interpolator
  const auto& ipo = wire.ipoData;
  check.Joints(ipo.has_jointPosition, ipo.jointPosition, m.q_ipo);
  check.Enum(ipo.has_clientCommandMode, ipo.clientCommandMode, FriCommandMode::kTorque, m.command_mode);
  check.Enum(ipo.has_overlayType, ipo.overlayType, FriOverlay::kCartesian, m.overlay);
  if (ipo.has_trackingPerformance) m.tracking_performance = ipo.trackingPerformance;
  check.Finite(m.tracking_performance);

  // what the session state promises
  const bool commanding = m.session >= SessionState::kCommandingWait;
  if ((m.session != SessionState::kIdle && !m.q_meas) || (commanding && !m.q_ipo))
    check.Fail(CodecError::kMissingField);

  if (check.error() == CodecError::kNone) message = m;
  return check.error();
}

CodecError EncodeCommand(const CommandMessage& message, std::span<std::uint8_t> buffer,
                         std::size_t& size) OSTEON_RT {
  osteon_fri_FRICommandMessage wire{};
  wire.header = {kFriCommandId, message.sequence, message.reflected_sequence};
  wire.has_commandData = message.q || message.wire_wrench || message.tau;
  auto& data = wire.commandData;
  bool finite = PutJoints(message.q, data.has_jointPosition, data.jointPosition);
  finite &= PutJoints(message.tau, data.has_jointTorque, data.jointTorque);
  data.has_cartesianWrenchFeedForward = message.wire_wrench.has_value();
  if (message.wire_wrench) {
    auto& wrench = data.cartesianWrenchFeedForward;
    wrench.element_count = 6;
    std::copy(message.wire_wrench->begin(), message.wire_wrench->end(), std::begin(wrench.element));
    for (const double element : wrench.element) finite &= std::isfinite(element);
  }
  if (!finite) return CodecError::kNotFinite;
  return Write(osteon_fri_FRICommandMessage_fields, &wire, buffer, size);
}

}  // namespace osteon::io
