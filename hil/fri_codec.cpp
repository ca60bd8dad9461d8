#include "hil/fri_codec.h"

#include <algorithm>
#include <stdexcept>

#include "fri_wire.pb.h"

namespace osteon::hil {
namespace {

void Put(const control::JointArray& from, fri::JointValues& to) {
  to.clear_value();
  for (const double v : from) to.add_value(v);
}

}  // namespace

struct FriCodec::Messages {
  fri::MonitoringMessage monitoring;
  fri::CommandMessage command;
};

FriCodec::FriCodec() : messages_(std::make_unique<Messages>()) {}
FriCodec::~FriCodec() = default;
FriCodec::FriCodec(FriCodec&&) noexcept = default;
FriCodec& FriCodec::operator=(FriCodec&&) noexcept = default;

std::span<const std::uint8_t> FriCodec::Encode(const FriMonitoring& c) {
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
  Put(c.q_meas, *data.mutable_measured_joint_position());
  Put(c.tau_meas, *data.mutable_measured_torque());
  Put(c.q_cmd, *data.mutable_commanded_joint_position());
  Put(c.tau_cmd, *data.mutable_commanded_torque());
  Put(c.tau_ext, *data.mutable_external_torque());
  data.mutable_timestamp()->set_sec(static_cast<std::uint32_t>(c.stamp / rt::kSecond));
  data.mutable_timestamp()->set_nanosec(static_cast<std::uint32_t>(c.stamp % rt::kSecond));

  fri::ConnectionInfo& connection = *m.mutable_connection_info();
  connection.set_session_state(static_cast<fri::SessionState>(c.session));
  connection.set_quality(static_cast<fri::ConnectionQuality>(c.quality));
  connection.set_send_period(c.send_period_ms);
  connection.set_receive_multiplier(c.receive_multiplier);

  fri::IpoData& ipo = *m.mutable_ipo_data();
  if (c.has_ipo)
    Put(c.q_ipo, *ipo.mutable_joint_position());
  else
    ipo.clear_joint_position();
  ipo.set_client_command_mode(c.has_ipo ? fri::POSITION : fri::NO_COMMAND);
  ipo.set_overlay_type(c.has_ipo ? fri::JOINT_OVERLAY : fri::NO_OVERLAY);
  ipo.set_tracking_performance(c.tracking_performance);

  const std::size_t size = m.ByteSizeLong();
  if (size > buffer_.size() || !m.SerializeToArray(buffer_.data(), static_cast<int>(buffer_.size())))
    throw std::logic_error("FRI monitoring message does not fit a datagram");
  return {buffer_.data(), size};
}

std::optional<FriCommand> FriCodec::Decode(std::span<const std::uint8_t> datagram) {
  if (datagram.empty() || datagram.size() > kFriMaxDatagram) return std::nullopt;
  // "partial", then asked for completeness: the strict call writes to stderr whatever a stranger sends
  fri::CommandMessage& m = messages_->command;
  if (!m.ParsePartialFromArray(datagram.data(), static_cast<int>(datagram.size())) || !m.IsInitialized())
    return std::nullopt;
  if (m.header().message_identifier() != kFriCommandId) return std::nullopt;

  FriCommand command;
  command.sequence = m.header().sequence_counter();
  command.reflected_sequence = m.header().reflected_sequence_counter();
  if (m.has_command_data() && m.command_data().has_joint_position()) {
    const auto& values = m.command_data().joint_position().value();
    command.has_joint_position = true;
    command.joint_count = values.size();
    std::copy_n(values.begin(), std::min(values.size(), control::kJoints), command.q.begin());
  }
  return command;
}

}  // namespace osteon::hil
