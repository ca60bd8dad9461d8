#include "hil/fri/fri_codec.h"

#include <algorithm>
#include <stdexcept>

#include "fri_wire.pb.h"

namespace osteon::hil {
namespace {

using io::FriFamily;

constexpr double kMmPerM = 1e3;
// bytes before a framed message (its length) and after it (its CRC-32)
constexpr std::size_t kHead = 4, kTail = 4;
constexpr const char* kMotionCentre = "flange";  // name of the frame of the arm's poses

void FillJoints(const control::JointArray& from, fri::JointValues& to) {
  to.clear_value();
  for (const double v : from) to.add_value(v);
}

// Computes the CRC-32 bit by bit, from its definition. io/ uses zlib's function, so the two implementations
// check each other.
std::uint32_t Crc32(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

// PutWord and ReadWord write and read a 32-bit number, the lowest byte first.
void PutWord(std::uint32_t value, std::uint8_t* to) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

std::uint32_t ReadWord(const std::uint8_t* from) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(from[i]) << (8 * i);
  return value;
}

// Returns the message without its frame; empty if the frame is wrong (a valid message is never empty).
std::span<const std::uint8_t> RemoveFrame(std::span<const std::uint8_t> datagram) {
  if (datagram.size() <= kHead + kTail) return {};
  const auto body = datagram.subspan(kHead, datagram.size() - kHead - kTail);
  const bool intact =
      ReadWord(datagram.data()) == body.size() && ReadWord(body.data() + body.size()) == Crc32(body);
  return intact ? body : std::span<const std::uint8_t>{};
}

// Position [mm], then the quaternion, w first.
void PutPose(const Pose& X, fri::Transformation& to) {
  to.Clear();
  to.set_name(kMotionCentre);
  const Vector3 p_mm = kMmPerM * X.translation();
  const Eigen::Quaterniond q(Matrix3(X.linear()));
  for (const double element : {p_mm.x(), p_mm.y(), p_mm.z(), q.w(), q.x(), q.y(), q.z()})
    to.add_element(element);
}

// Sets the redundancy information: the angle of the redundant joint A3.
void PutRedundancy(const control::JointArray& q, fri::Redundancy& to) {
  to.set_strategy(0);
  to.set_value(q[2]);
}

}  // namespace

struct FriCodec::Messages {
  fri::MonitoringMessage monitoring;
  fri::CommandMessage command;
};

FriCodec::FriCodec(io::FriVersion version)
    : family_(io::FamilyOf(version)), messages_(std::make_unique<Messages>()) {}
FriCodec::~FriCodec() = default;
FriCodec::FriCodec(FriCodec&&) noexcept = default;
FriCodec& FriCodec::operator=(FriCodec&&) noexcept = default;

std::span<const std::uint8_t> FriCodec::Encode(const FriMonitoring& c) {
  const bool has_poses = family_ != FriFamily::k1;
  fri::MonitoringMessage& m = messages_->monitoring;
  m.mutable_header()->set_message_identifier(kFriMonitoringId);
  m.mutable_header()->set_sequence_counter(c.sequence);
  m.mutable_header()->set_reflected_sequence_counter(c.reflected_sequence);

  fri::RobotInfo& robot = *m.mutable_robot_info();
  robot.set_number_of_joints(control::kJoints);
  robot.set_safety_state(static_cast<fri::SafetyState>(c.safety_state));
  robot.clear_drive_state();
  for (int i = 0; i < control::kJoints; ++i)
    robot.add_drive_state(static_cast<fri::DriveState>(c.drive_state));
  robot.set_operation_mode(static_cast<fri::OperationMode>(c.operation_mode));
  robot.set_control_mode(static_cast<fri::ControlMode>(c.control_mode));

  fri::MonitorData& data = *m.mutable_monitor_data();
  FillJoints(c.q_meas, *data.mutable_measured_joint_position());
  FillJoints(c.tau_meas, *data.mutable_measured_torque());
  if (!has_poses) FillJoints(c.q_cmd, *data.mutable_commanded_joint_position());
  FillJoints(c.tau_cmd, *data.mutable_commanded_torque());
  FillJoints(c.tau_ext, *data.mutable_external_torque());
  if (family_ == FriFamily::k2_7) {
    data.mutable_external_force()->clear_element();
    for (const double v : c.wire_force) data.mutable_external_force()->add_element(v);
  }
  if (has_poses) {
    PutPose(c.X_meas, *data.mutable_measured_cartesian_pose());
    PutRedundancy(c.q_meas, *data.mutable_measured_redundancy());
  }
  data.mutable_timestamp()->set_sec(static_cast<std::uint32_t>(c.stamp / rt::kSecond));
  data.mutable_timestamp()->set_nanosec(static_cast<std::uint32_t>(c.stamp % rt::kSecond));

  fri::ConnectionInfo& connection = *m.mutable_connection_info();
  connection.set_session_state(static_cast<fri::SessionState>(c.session));
  connection.set_quality(static_cast<fri::ConnectionQuality>(c.quality));
  connection.set_send_period(c.send_period_ms);
  connection.set_receive_multiplier(c.receive_multiplier);

  fri::IpoData& ipo = *m.mutable_ipo_data();
  if (c.has_ipo) {
    FillJoints(c.q_ipo, *ipo.mutable_joint_position());
    if (has_poses) {
      PutPose(c.X_ipo, *ipo.mutable_cartesian_pose());
      PutRedundancy(c.q_ipo, *ipo.mutable_redundancy());
    }
  } else {
    ipo.clear_joint_position();
    ipo.clear_cartesian_pose();
    ipo.clear_redundancy();
  }
  ipo.set_client_command_mode(c.has_ipo ? static_cast<fri::ClientCommandMode>(c.command_mode)
                                        : fri::NO_COMMAND);
  ipo.set_overlay_type(c.has_ipo ? fri::JOINT_OVERLAY : fri::NO_OVERLAY);
  ipo.set_tracking_performance(c.tracking_performance);

  const bool framed = family_ == FriFamily::k2_7;
  const std::size_t head = framed ? kHead : 0, frame_bytes = framed ? kHead + kTail : 0;
  const std::size_t size = m.ByteSizeLong();
  if (size + frame_bytes > buffer_.size() ||
      !m.SerializeToArray(buffer_.data() + head, static_cast<int>(buffer_.size() - frame_bytes)))
    throw std::logic_error("FRI monitoring message does not fit a datagram");
  if (framed) {
    PutWord(static_cast<std::uint32_t>(size), buffer_.data());
    PutWord(Crc32({buffer_.data() + head, size}), buffer_.data() + head + size);
  }
  return {buffer_.data(), size + frame_bytes};
}

bool FriCodec::Parse(std::span<const std::uint8_t> body) {
  // Parse as "partial", then check that required fields are present, because the strict parse function writes
  // to stderr if they are missing.
  fri::CommandMessage& m = messages_->command;
  return !body.empty() && m.ParsePartialFromArray(body.data(), static_cast<int>(body.size())) &&
         m.IsInitialized() && m.header().message_identifier() == kFriCommandId;
}

std::optional<FriCommand> FriCodec::Decode(std::span<const std::uint8_t> datagram) {
  if (datagram.size() > kFriMaxDatagram) return std::nullopt;
  if (!Parse(family_ == FriFamily::k2_7 ? RemoveFrame(datagram) : datagram)) return std::nullopt;

  const fri::CommandMessage& m = messages_->command;
  FriCommand command;
  command.sequence = m.header().sequence_counter();
  command.reflected_sequence = m.header().reflected_sequence_counter();
  if (!m.has_command_data()) return command;
  const fri::CommandData& data = m.command_data();
  // copies as many values as fit; returns the number of values in the message
  const auto copy_values = [](const auto& values, auto& to) {
    std::copy_n(values.begin(), std::min<std::size_t>(static_cast<std::size_t>(values.size()), to.size()),
                to.begin());
    return values.size();
  };
  command.has_joint_position = data.has_joint_position();
  command.joint_count = copy_values(data.joint_position().value(), command.q);
  command.has_wrench = data.has_cartesian_wrench_feed_forward();
  command.wrench_count = copy_values(data.cartesian_wrench_feed_forward().element(), command.wire_wrench);
  command.has_torque = data.has_joint_torque();
  command.torque_count = copy_values(data.joint_torque().value(), command.tau);
  return command;
}

bool FriCodec::IsOfOtherVersion(std::span<const std::uint8_t> datagram) {
  if (datagram.size() > kFriMaxDatagram) return false;
  return Parse(family_ == FriFamily::k2_7 ? datagram : RemoveFrame(datagram));
}

}  // namespace osteon::hil
