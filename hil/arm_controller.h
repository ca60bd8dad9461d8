#pragma once

#include <cstdint>
#include <span>

#include "base/clock.h"
#include "control/ports.h"
#include "hil/fri/fri_server.h"
#include "hil/fri/fri_stop.h"
#include "hil/rsi/rsi_controller.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// State of the arm's end of the session. Plain data.
struct ArmStatus {
  /// On RSI: the equivalent FRI state, see RsiArm.
  control::SessionState session{control::SessionState::kIdle};
  FriCounters counters;    ///< on RSI only the fields sent … malformed, and stale (late answers), are used
  StopReport stop;         ///< last stop of an arm on FRI
  RsiStopReport rsi_stop;  ///< last stop of an arm on RSI
  std::uint32_t delay{0};  ///< late answers, as counted in RSI's last message; 0 on FRI
};

/// Describes in one line, with the numbers, why the arm ended commanding; empty if it did not end.
[[nodiscard]] std::string DescribeStop(const ArmStatus& status);

/// Expresses in frame A a wrench that is given in frame B; the wrench's point does not change.
[[nodiscard]] inline Wrench ExpressedIn(const Matrix3& R_AB, const Wrench& F_B) {
  return {.f = R_AB * F_B.f, .t = R_AB * F_B.t};
}

/// The arm's joints, and its tool's pose and velocity.
struct ArmMotion {
  control::JointArray q_meas{}, q_cmd{};  ///< [rad]; the seventh joint of a six-axis arm is 0
  Pose X_BT{Pose::Identity()};            ///< pose of the tool, computed from the joints' positions
  Twist V_BT;                             ///< velocity of T in B, expressed in B
  /// Present pose of the base, relative to its pose at rest (the mount may be flexible). Joints and X_BT are
  /// relative to the present base.
  Pose X_BBnow{Pose::Identity()};
};

/// Interface of the arm and its controller for the simulated cell, independent of the protocol. It has no
/// socket and no clock. The calls of one period are
///
///     Receive() for each datagram that came  →  Move()  →  motion(), input of the hand's model  →  Message()
///
/// Two objects with the same input send the same bytes. One thread at a time.
class ArmController {
 public:
  virtual ~ArmController() = default;

  /// Accepts one datagram of the client, which may be malformed. Returns true if it answers the message last
  /// sent.
  virtual bool Receive(std::span<const std::uint8_t> datagram) = 0;

  /// Evaluates the datagrams received since the last call and moves the arm by one period.
  /// @param client_had_its_time  false if the arm's side itself was late: a missing answer is then not
  /// counted as the client's loss
  /// @param F_T_B  wrench on the tool during the period, at T's origin, in B
  virtual void Move(bool client_had_its_time, const Wrench& F_T_B) = 0;

  /// Returns the next datagram to send, empty if there is none; valid until the next call.
  /// @param F_T_T  wrench on the tool now, at T's origin, in T  @param now  >= 0
  [[nodiscard]] virtual std::span<const std::uint8_t> Message(const Wrench& F_T_T, rt::Nanoseconds now) = 0;

  /// Switches the drives' power, as a PLC does. The power is on initially. Without power the drives stop at
  /// once (Stop 0). When power returns, the stop is acknowledged and the program starts again.
  virtual void SetPower(bool on) = 0;

  /// Ends the robot's program. @returns true if the arm announces the end: it still sends messages until
  /// Message() is empty. False: it sends no further message.
  [[nodiscard]] virtual bool EndSession() { return false; }

  [[nodiscard]] virtual ArmMotion motion() const = 0;
  [[nodiscard]] virtual ArmStatus status() const = 0;
  [[nodiscard]] virtual double period_s() const = 0;
};

}  // namespace osteon::hil
