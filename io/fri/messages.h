#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "control/ports.h"

// FRI 1.15 messages as plain data. The enums' numbers are the wire's.

namespace osteon::io {

enum class FriQuality : std::uint8_t { kPoor = 0, kFair = 1, kGood = 2, kExcellent = 3 };
enum class FriSafetyState : std::uint8_t { kNormal = 0, kStopLevel0 = 1, kStopLevel1 = 2, kStopLevel2 = 3 };
enum class FriOperationMode : std::uint8_t { kT1 = 0, kT2 = 1, kAutomatic = 2 };
enum class FriDriveState : std::uint8_t { kOff = 0, kTransitioning = 1, kActive = 2 };
enum class FriControlMode : std::uint8_t {
  kPosition = 0,
  kCartesianImpedance = 1,
  kJointImpedance = 2,
  kNone = 3
};
enum class FriCommandMode : std::uint8_t { kNone = 0, kPosition = 1, kWrench = 2, kTorque = 3 };
enum class FriOverlay : std::uint8_t { kNone = 0, kJoint = 1, kCartesian = 2 };

/// The arm's clock.
struct FriTime {
  std::uint32_t sec{0}, nanosec{0};
};

/// What the arm sends each period.
struct MonitoringMessage {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};  ///< of the last command that the arm has seen
  control::SessionState session{control::SessionState::kIdle};
  FriQuality quality{FriQuality::kPoor};
  std::uint32_t send_period_ms{1};      ///< 1 … 100
  std::uint32_t receive_multiplier{1};  ///< the client answers every so many messages; 1 … 100
  FriSafetyState safety{FriSafetyState::kNormal};
  FriOperationMode operation{FriOperationMode::kT1};
  FriControlMode control{FriControlMode::kPosition};
  std::array<FriDriveState, control::kJoints> drives{};
  std::optional<control::JointArray> q_meas;    ///< [rad]
  std::optional<control::JointArray> tau_meas;  ///< [N·m]
  std::optional<control::JointArray> q_cmd;     ///< [rad] what the arm took as commanded
  std::optional<control::JointArray> tau_cmd;   ///< [N·m]
  std::optional<control::JointArray> tau_ext;   ///< [N·m] external, the arm's estimate
  std::optional<control::JointArray> q_ipo;     ///< [rad] the arm's interpolator; in COMMANDING_* only
  FriCommandMode command_mode{FriCommandMode::kNone};
  FriOverlay overlay{FriOverlay::kNone};
  double tracking_performance{0.0};  ///< 0 … 1; 0 outside COMMANDING_ACTIVE
  std::optional<FriTime> time;
};

/// What the client answers. Without joint positions, torques and wrench it is the header alone.
struct CommandMessage {
  std::uint32_t sequence{0};
  std::uint32_t reflected_sequence{0};     ///< of the monitoring message that it answers
  std::optional<control::JointArray> q{};  ///< [rad]
  /// Fx Fy Fz [N], torques about A, B, C [N·m]: the wire's order.
  std::optional<std::array<double, 6>> wire_wrench{};
  std::optional<control::JointArray> tau{};  ///< [N·m]
};

}  // namespace osteon::io
