#pragma once

#include <array>
#include <cstdint>

#include "control/rt/clock.h"
#include "control/rt/marker.h"
#include "control/tick_record.h"
#include "kinematics/spatial.h"

// What the servo loop needs of the world. io implements it; virtual time brings its own.

namespace osteon::control {

inline constexpr int kJoints = 7;
using JointArray = std::array<double, kJoints>;

/// FRI session states; the numbers are the wire's.
enum class SessionState : std::uint8_t {
  kIdle = 0,
  kMonitoringWait = 1,
  kMonitoringReady = 2,
  kCommandingWait = 3,
  kCommandingActive = 4,
};

/// One message from the arm.
struct ArmState {
  rt::Nanoseconds stamp{0};  ///< when it arrived here
  std::uint32_t sequence{0};
  SessionState session{SessionState::kIdle};
  std::uint8_t quality{0};       ///< 0 poor … 3 excellent
  std::uint8_t safety_state{0};  ///< 0 normal, 1 … 3 stop level 0 … 2
  double period_s{0.001};
  JointArray q_meas{};  ///< [rad]
  JointArray q_ipo{};   ///< [rad] the arm's own interpolator; valid in COMMANDING_*
  bool has_ipo{false};
  JointArray tau_ext{};                                       ///< [N·m] external torque, the arm's estimate
  std::uint32_t lost{0}, duplicate{0}, late{0}, rejected{0};  ///< messages so far
};

/// What the loop answers: where the joints should be. In states in which the arm moves by itself, the link
/// mirrors instead.
struct ArmCommand {
  JointArray q{};  ///< [rad]
};

enum class ReceiveResult : std::uint8_t { kOk, kTimeout, kClosed };

class ArmLink {
 public:
  virtual ~ArmLink() = default;
  /// Waits for the arm's next message, at most until the deadline. Hostile bytes are counted (`rejected`) and
  /// skipped.
  virtual ReceiveResult Receive(ArmState& state, rt::Nanoseconds deadline) OSTEON_RT = 0;
  /// Answers the message last received. False where the system could not send.
  virtual bool Send(const ArmCommand& command) OSTEON_RT = 0;
};

/// One reading of the force sensor.
struct ForceReading {
  rt::Nanoseconds stamp{0};  ///< 0: none yet
  PlainWrench F_T_W;         ///< what the hand exerts on the tool, at T's origin, in W, tool weight taken out
};

class ForceSensor {
 public:
  virtual ~ForceSensor() = default;
  /// The newest reading.
  [[nodiscard]] virtual ForceReading Latest() OSTEON_RT = 0;
};

class TickRecorder {
 public:
  virtual ~TickRecorder() = default;
  /// False where the recorder is behind; the tick goes on.
  virtual bool Push(const TickRecord& record) OSTEON_RT = 0;
};

}  // namespace osteon::control
