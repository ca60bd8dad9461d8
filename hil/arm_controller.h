#pragma once

#include <cstdint>
#include <span>

#include "control/ports.h"
#include "control/rt/clock.h"
#include "hil/fri_server.h"
#include "hil/fri_stop.h"
#include "hil/rsi/rsi_controller.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// What an arm's end of its session has come to. Plain data.
struct ArmStatus {
  control::SessionState session{control::SessionState::kIdle};  ///< of RSI: what RsiArm says it stands for
  FriCounters counters;    ///< of RSI those that it has: sent … malformed; stale: late answers
  StopReport stop;         ///< of an arm on FRI
  RsiStopReport rsi_stop;  ///< of an arm on RSI
  std::uint32_t delay{0};  ///< late answers, as RSI's last message says; 0 on FRI
};

/// Why the arm ended commanding, in one line with the figures; empty where it did not.
[[nodiscard]] std::string DescribeStop(const ArmStatus& status);

/// The same wrench, expressed in A.
[[nodiscard]] inline Wrench Turned(const Matrix3& R_AB, const Wrench& F_B) {
  return {.f = R_AB * F_B.f, .t = R_AB * F_B.t};
}

/// How the arm stands and moves.
struct ArmMotion {
  control::JointArray q_meas{}, q_cmd{};  ///< [rad]; a seventh joint that there is not is 0
  Pose X_BT{Pose::Identity()};            ///< the tool, as the joints say
  Twist V_BT;                             ///< of T in B, expressed in B
  /// Where the base is, seen from where it stands at rest; the joints are measured from it.
  Pose X_BBnow{Pose::Identity()};
};

/// The arm with its controller, as the cell sees it: whichever protocol it speaks. No socket and no clock; a
/// period is
///
///     Receive() for each datagram that came  →  Move()  →  motion(), what the hand does with it  → Message()
///
/// Two with the same input give the same bytes. One thread at a time.
class ArmController {
 public:
  virtual ~ArmController() = default;

  /// One datagram of the client, however odd. True where it answers the message last sent.
  virtual bool Receive(std::span<const std::uint8_t> datagram) = 0;

  /// Judges what was received and moves the arm by one period.
  /// @param client_had_its_time  false where this side was late: a missing answer is then not held against
  ///   the client
  /// @param F_T_B  what has pressed on the tool during the period, at T's origin, in B
  virtual void Move(bool client_had_its_time, const Wrench& F_T_B) = 0;

  /// The next datagram, empty where there is none; valid until the next call.
  /// @param F_T_T  what presses on the tool now, at T's origin, in T  @param now  >= 0
  [[nodiscard]] virtual std::span<const std::uint8_t> Message(const Wrench& F_T_T, rt::Nanoseconds now) = 0;

  /// The drives' power, which a PLC switches; on at first. Without it they stop at once (Stop 0); with it
  /// back the stop is acknowledged and the program begins anew.
  virtual void SetPower(bool on) = 0;

  /// The robot's program ends. @returns true where the arm says so: its messages to come are the last ones,
  /// until Message() is empty. False: it falls silent.
  [[nodiscard]] virtual bool EndSession() { return false; }

  [[nodiscard]] virtual ArmMotion motion() const = 0;
  [[nodiscard]] virtual ArmStatus status() const = 0;
  [[nodiscard]] virtual double period_s() const = 0;
};

}  // namespace osteon::hil
