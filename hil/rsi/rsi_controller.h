#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "hil/arm/arm_model.h"
#include "hil/arm/servo_arm.h"
#include "hil/rsi/rsi_wire.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/serial_chain.h"

namespace osteon::hil {

/// Setup of the simulated KR and its RSI program.
struct RsiControllerParams {
  kinematics::OrthoParallelParams arm{};  ///< no default
  Six start_deg{0.0, -90.0, 90.0, 0.0, 90.0, 0.0};
  int cycle_ms{4};  ///< 4 (IPO_FAST) or 12 (IPO)
  RsiFormat format{RsiFormat::kImFree};
  bool cartesian{false};  ///< expects <RKorr>, otherwise <AK>
  bool absolute{true};    ///< true: corrections count from the pose at the start; false: they add up
  bool hold_on{true};     ///< true: a cycle without an answer repeats the last correction; false: none
  int timeout_cycles{100};
  /// Timeout ends RSI when Delay reaches it. False: Delay counts every late answer since the start; true:
  /// only those in a row.
  bool delay_in_a_row{false};
  std::uint64_t first_ipoc{4'208'163'634};
  int ipoc_step{4};
  /// Range of the correction from the start pose, in both directions: [deg], of RKorr mm for X Y Z.
  Six range{90.0, 90.0, 90.0, 90.0, 90.0, 90.0};
  /// Limit of the axes' commanded speed, as a share of each axis's own limit; > 0. Infinite: none.
  double axis_speed_ratio{1.0};
  ArmLevel level{ArmLevel::kServo};  ///< kKinematic or kServo: the masses of these arms are not published
  ServoArmParams servo{.dead_cycles = 1};
};

enum class RsiStopReason : std::uint8_t {
  kNone,
  kTimeout,          ///< Delay reached timeout_cycles
  kAskedFor,         ///< <Stop>1</Stop>
  kCorrectionRange,  ///< a correction beyond its monitor's range
  kAxisLimit,        ///< a set point beyond the axis's software limit
  kAxisSpeed,        ///< a set point that the axis cannot reach within the cycle (KSS01102)
  kOutOfReach,       ///< no posture for a corrected pose
  kPowerOff,         ///< the drives lost their power
};

/// Why RSI ended. Plain data.
struct RsiStopReport {
  RsiStopReason reason{RsiStopReason::kNone};
  int axis{0};  ///< 1 … 6 if one axis is to blame (of RKorr: X Y Z A B C)
  double found{0.0}, accepted{0.0};
};

/// One line with the figures, e.g. "correction range: number 2 corrected by 91, accepted 90".
[[nodiscard]] std::string Describe(const RsiStopReport& stop);

/// Numbers of messages and answers so far.
struct RsiCounters {
  std::uint64_t sent{0}, answered{0};
  std::uint64_t missed{0};      ///< cycles without an answer in time
  std::uint64_t excused{0};     ///< cycles without an answer because the controller itself was late
  std::uint64_t late{0};        ///< answers to an earlier cycle
  std::uint64_t wrong_ipoc{0};  ///< answers to a cycle that never existed
  std::uint64_t duplicate{0};
  std::uint64_t malformed{0};
};

/// State of the controller after a step. Plain data.
struct RsiControllerState {
  bool running{true};
  std::uint64_t ipoc{0};   ///< of the message last sent
  std::uint32_t delay{0};  ///< as in that message
  Six axes_set_deg{}, axes_measured_deg{};
  Six correction{};  ///< in force, from the start pose
  RsiCounters counters;
  RsiStopReport stop;
};

/// A KR's controller while RSI runs: bytes in, bytes out, one Step() a cycle, in virtual and wall time alike.
/// Two runs with the same input give the same bytes.
///
///     Step: was the last message answered?  →  correction in force  →  set point  →  servo  →  next message
///
/// An answer counts if it echoes the IPOC of the message last sent and comes before the next Step. Otherwise
/// Delay rises, and RSI ends at Timeout. With HOLDON, such a cycle repeats the last correction: the sum of
/// relative corrections grows by it again. Without HOLDON, the cycle has no correction: with absolute ones
/// the set point jumps back to the start pose, with relative ones the sum stays.
///
/// RKorr is about the base's axes at the flange's origin: p = p_start + (X Y Z), R = Rz(A) Ry(B) Rx(C)
/// R_start; relative ones add up number by number. The program's tool and base are flange and robot root.
///
/// A set point that exceeds an axis's speed also ends RSI and is not followed, as KSS does with "KSS01102
/// Command velocity".
///
/// **Assumptions.** None of these was measured: when exactly a real controller calls an answer late, what its
/// Delay counts (both ways are implemented), that a dropped answer stays dropped, where exactly the speed is
/// monitored, and lag and dead time of the axes (ServoArm). Only corrections move the arm, not the program.
/// When RSI ends, the set point stays where it is.
class RsiController {
 public:
  /// @throws std::invalid_argument on a parameter out of range, naming it.
  explicit RsiController(const RsiControllerParams& params);

  /// Takes one datagram of the PC. True if it answers the message last sent.
  bool Receive(std::span<const std::uint8_t> datagram);

  /// Runs one cycle.
  /// @param client_had_its_time  false if this side was late: a missing answer still raises Delay, from which
  ///   the PC reads what became of its answers, but does not count toward Timeout.
  /// @returns the datagram to send, valid until the next call; empty once RSI has ended.
  std::span<const std::uint8_t> Step(bool client_had_its_time = true);

  /// Cuts the drives' power: RSI ends.
  void PowerOff();

  /// Starts RSI again at the arm's present pose, as the program's next RSI_ON does.
  void Restart();

  [[nodiscard]] const RsiControllerState& state() const { return state_; }
  [[nodiscard]] const kinematics::JointVectorN<6>& q() const { return q_; }    ///< [rad]
  [[nodiscard]] const kinematics::JointVectorN<6>& qd() const { return qd_; }  ///< [rad/s]
  [[nodiscard]] double period_s() const { return 1e-3 * params_.cycle_ms; }
  /// Reason why the last malformed datagram was rejected.
  [[nodiscard]] const std::string& last_error() const { return last_error_; }

 private:
  void Judge(bool client_had_its_time);
  void ApplyCorrection();
  void Drive();
  void End(RsiStopReason reason, int axis, double found, double accepted);

  RsiControllerParams params_;
  kinematics::OrthoParallelArm arm_;
  kinematics::SerialChain<6> chain_;
  ServoArm servo_;
  Six start_deg_;
  kinematics::JointVectorN<6> q_set_, q_, qd_{kinematics::JointVectorN<6>::Zero()};
  Pose X_BF_start_;
  Six last_{};  // correction of the last answer
  SenMessage answer_;
  bool answered_{false};
  std::uint32_t excused_delay_{0};  // part of state_.delay
  std::uint64_t first_ipoc_;        // of this session
  RsiControllerState state_;
  std::string text_, last_error_;
};

}  // namespace osteon::hil
