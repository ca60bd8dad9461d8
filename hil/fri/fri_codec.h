#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/clock.h"
#include "control/ports.h"
#include "io/fri/version.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

inline constexpr std::size_t kFriMaxDatagram = 1500;
inline constexpr std::uint32_t kFriMonitoringId = 0x245142;
inline constexpr std::uint32_t kFriCommandId = 0x34001;

/// Content of a monitoring message, as plain data. Joints in rad and N·m. Fields that the protocol version
/// does not have are not sent.
struct FriMonitoring {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};
  control::SessionState session{control::SessionState::kIdle};
  std::uint8_t quality{0};         ///< 0 poor … 3 excellent
  std::uint8_t safety_state{0};    ///< 0 normal, 1 … 3 stop level 0 … 2
  std::uint8_t drive_state{2};     ///< of every joint: 0 off, 1 transitioning, 2 active
  std::uint8_t operation_mode{2};  ///< 0 T1, 1 T2, 2 AUT
  control::ControlMode control_mode{control::ControlMode::kPosition};
  std::uint32_t send_period_ms{1};
  std::uint32_t receive_multiplier{1};
  control::JointArray q_meas{}, tau_meas{}, q_cmd{}, tau_cmd{}, tau_ext{};
  /// External wrench in the wire's order of elements; only in version 2.7.
  std::array<double, 6> wire_force{};
  PlainPose X_meas{}, X_ipo{};  ///< poses of the motion centre, in the robot's base; only in versions 2.x
  /// True in commanding states: q_ipo, the command mode and overlay JOINT are sent.
  bool has_ipo{false};
  control::CommandMode command_mode{control::CommandMode::kPosition};
  control::JointArray q_ipo{};
  double tracking_performance{0.0};
  rt::Nanoseconds stamp{0};  ///< >= 0
};

/// Content of a client's command message. Values as sent: they may be NaN.
struct FriCommand {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};
  bool has_joint_position{false}, has_wrench{false}, has_torque{false};
  /// Numbers of values in the message; the arrays below hold the first seven or six.
  int joint_count{0}, wrench_count{0}, torque_count{0};
  control::JointArray q{};              ///< [rad]
  std::array<double, 6> wire_wrench{};  ///< [N, N·m], in the wire's order of elements
  control::JointArray tau{};            ///< [N·m]
};

/// Writes monitoring messages and reads command messages with libprotobuf; for version 2.7 it adds a frame
/// (length and CRC-32), computed by its own code. Message objects are reused, so after the first message of
/// each kind only a malformed message may cause an allocation.
class FriCodec {
 public:
  explicit FriCodec(io::FriVersion version = io::FriVersion::k1_15);
  ~FriCodec();
  FriCodec(FriCodec&&) noexcept;
  FriCodec& operator=(FriCodec&&) noexcept;

  /// Returns the datagram; valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Encode(const FriMonitoring& content);

  /// Empty if the bytes are not a complete command message (too long, undecodable, a required field missing,
  /// a wrong id, or a frame that is not that of the version).
  [[nodiscard]] std::optional<FriCommand> Decode(std::span<const std::uint8_t> datagram);

  /// Whether this datagram would be a command message with the frame of another version.
  [[nodiscard]] bool IsOfOtherVersion(std::span<const std::uint8_t> datagram);

 private:
  struct Messages;
  // Parses a message without its frame into messages_. Returns true if it is a complete command message.
  [[nodiscard]] bool Parse(std::span<const std::uint8_t> body);

  io::FriFamily family_;
  std::unique_ptr<Messages> messages_;
  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::hil
