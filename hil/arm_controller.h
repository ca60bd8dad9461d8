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
  control::SessionState session{control::SessionState::kIdle};  ///< on RSI: the FRI state that RsiArm reports
                                                                ///< as equivalent
  FriCounters counters;    ///< on RSI only sent … malformed and stale (late answers)
  StopReport stop;         ///< of an arm on FRI
  RsiStopReport rsi_stop;  ///< of an arm on RSI
  std::uint32_t delay{0};  ///< late answers, as counted in RSI's last message; 0 on FRI
};

/// Why the arm ended commanding, in one line with the figures; empty if it did not.
[[nodiscard]] std::string DescribeStop(const ArmStatus& status);

/// Expresses in A a wrench that is given in B; the point stays.
[[nodiscard]] inline Wrench ExpressedIn(const Matrix3& R_AB, const Wrench& F_B) {
  return {.f = R_AB * F_B.f, .t = R_AB * F_B.t};
}

/// The arm's joints, and its tool's pose and velocity.
struct ArmMotion {
  control::JointArray q_meas{}, q_cmd{};  ///< [rad]; the seventh joint of a six-axis arm is 0
  Pose X_BT{Pose::Identity()};            ///< the tool, from the joints' positions
  Twist V_BT;                             ///< of T in B, expressed in B
  /// Present pose of the base, relative to its pose at rest; joints and X_BT are relative to the present one.
  Pose X_BBnow{Pose::Identity()};
};

/// The arm and its controller as the cell sees them, independent of the protocol. No socket and no clock. A
/// period is
///
///     Receive() for each datagram that came  →  Move()  →  motion(), which the hand answers  →  Message()
///
/// Two objects with the same input give the same bytes. One thread at a time.
class ArmController {
 public:
  virtual ~ArmController() = default;

  /// Takes one datagram of the client, however malformed. True if it answers the message last sent.
  virtual bool Receive(std::span<const std::uint8_t> datagram) = 0;

  /// Judges what was received and moves the arm by one period.
  /// @param client_had_its_time  false if this side was late: a missing answer is then not counted against
  ///   the client
  /// @param F_T_B  wrench on the tool during the period, at T's origin, in B
  virtual void Move(bool client_had_its_time, const Wrench& F_T_B) = 0;

  /// The next datagram, empty if there is none; valid until the next call.
  /// @param F_T_T  wrench on the tool now, at T's origin, in T  @param now  >= 0
  [[nodiscard]] virtual std::span<const std::uint8_t> Message(const Wrench& F_T_T, rt::Nanoseconds now) = 0;

  /// Switches the drives' power, as a PLC does; on at first. Without power the drives stop at once (Stop 0).
  /// When power returns, the stop is acknowledged and the program starts again.
  virtual void SetPower(bool on) = 0;

  /// Ends the robot's program. @returns true if the arm announces the end: its next messages are the last
  /// ones, until Message() is empty. False: it falls silent.
  [[nodiscard]] virtual bool EndSession() { return false; }

  [[nodiscard]] virtual ArmMotion motion() const = 0;
  [[nodiscard]] virtual ArmStatus status() const = 0;
  [[nodiscard]] virtual double period_s() const = 0;
};

}  // namespace osteon::hil
