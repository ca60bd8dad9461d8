#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "control/ports.h"
#include "control/rt/clock.h"

namespace osteon::hil {

inline constexpr std::size_t kFriMaxDatagram = 1500;
inline constexpr std::uint32_t kFriMonitoringId = 0x245142;
inline constexpr std::uint32_t kFriCommandId = 0x34001;

/// What a monitoring message of FRI 1.15 says, as plain data. Joints in rad and N·m.
struct FriMonitoring {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};
  control::SessionState session{control::SessionState::kIdle};
  std::uint8_t quality{0};         ///< 0 poor … 3 excellent
  std::uint8_t safety_state{0};    ///< 0 normal, 1 … 3 stop level 0 … 2
  std::uint8_t drive_state{2};     ///< of every joint: 0 off, 1 transitioning, 2 active
  std::uint8_t operation_mode{2};  ///< 0 T1, 1 T2, 2 AUT
  std::uint8_t control_mode{0};    ///< 0 position
  std::uint32_t send_period_ms{1};
  std::uint32_t receive_multiplier{1};
  control::JointArray q_meas{}, tau_meas{}, q_cmd{}, tau_cmd{}, tau_ext{};
  bool has_ipo{false};  ///< commanding states: q_ipo is sent, command mode POSITION, overlay JOINT
  control::JointArray q_ipo{};
  double tracking_performance{0.0};
  rt::Nanoseconds stamp{0};  ///< >= 0
};

/// What a client's command message says.
struct FriCommand {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};
  bool has_joint_position{false};
  int joint_count{0};       ///< as sent; q holds the first seven
  control::JointArray q{};  ///< [rad], as sent: may be NaN
};

/// Writes monitoring messages and reads command messages with libprotobuf. Reuses its message objects, so
/// that it does not allocate once each kind of message has passed (an odd message may make it allocate
/// again).
class FriCodec {
 public:
  FriCodec();
  ~FriCodec();
  FriCodec(FriCodec&&) noexcept;
  FriCodec& operator=(FriCodec&&) noexcept;

  /// The datagram; valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Encode(const FriMonitoring& content);

  /// Empty where the bytes are not a complete command message (too long, undecodable, a required field or the
  /// id wrong).
  [[nodiscard]] std::optional<FriCommand> Decode(std::span<const std::uint8_t> datagram);

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::hil
