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

/// Parameters of the simulated KR and of its RSI program.
struct RsiControllerParams {
  kinematics::OrthoParallelParams arm{};  ///< the KR's geometry and limits; there is no default
  Six start_deg{0.0, -90.0, 90.0, 0.0, 90.0, 0.0};
  int cycle_ms{4};  ///< 4 (IPO_FAST) or 12 (IPO)
  RsiFormat format{RsiFormat::kImFree};
  bool cartesian{false};  ///< expects <RKorr>, otherwise <AK>
  bool absolute{true};  ///< true: corrections are relative to the start pose; false: each correction is added
                        ///< to the sum of the previous ones
  bool hold_on{true};   ///< HOLDON. True: a cycle without an answer uses the last correction again; false: it
                        ///< has no correction
  int timeout_cycles{100};
  /// RSI ends when Delay reaches Timeout (timeout_cycles). False: Delay counts all late answers since the
  /// start; true: only consecutive ones.
  bool delay_in_a_row{false};
  std::uint64_t first_ipoc{4'208'163'634};
  int ipoc_step{4};
  /// Largest magnitude of each element of the correction from the start pose [deg]; for RKorr, X Y Z in [mm].
  Six range{90.0, 90.0, 90.0, 90.0, 90.0, 90.0};
  /// Limit of each axis's commanded speed, as a multiple of the axis's own limit; > 0. Infinite: no limit.
  double axis_speed_ratio{1.0};
  ArmLevel level{ArmLevel::kServo};  ///< kKinematic or kServo; kDynamic is not possible, because the masses
                                     ///< of KR arms are not published
  ServoArmParams servo{.dead_cycles = 1};
};

enum class RsiStopReason : std::uint8_t {
  kNone,
  kTimeout,          ///< Delay reached timeout_cycles
  kAskedFor,         ///< the PC sent <Stop>1</Stop>
  kCorrectionRange,  ///< a correction was beyond the monitor's range
  kAxisLimit,        ///< a set point was beyond the axis's software limit
  kAxisSpeed,        ///< a set point needed more than the axis's speed limit (KSS01102)
  kOutOfReach,       ///< no posture of the arm reaches a corrected pose
  kPowerOff,         ///< the drives lost their power
};

/// The reason why RSI ended. Plain data.
struct RsiStopReport {
  RsiStopReason reason{RsiStopReason::kNone};
  /// 1 … 6 if one axis caused the end, otherwise 0; for the range of RKorr, the element X Y Z A B C.
  int axis{0};
  double found{0.0}, accepted{0.0};
};

/// Describes the stop in one line with the numbers, e.g. "correction range: number 2 corrected by 91,
/// accepted 90".
[[nodiscard]] std::string Describe(const RsiStopReport& stop);

/// Counters of messages and answers since RSI's start.
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
  std::uint64_t ipoc{0};   ///< IPOC of the message last sent
  std::uint32_t delay{0};  ///< Delay in the message last sent
  Six axes_set_deg{}, axes_measured_deg{};
  Six correction{};  ///< applied correction from the start pose
  RsiCounters counters;
  RsiStopReport stop;
};

/// A KR's controller while RSI runs. It converts received bytes to bytes to send, with one Step() per cycle,
/// in virtual time or wall time. Two runs with the same input send the same bytes.
///
///     Step: was the last message answered?  →  applied correction  →  set point  →  servo  →  next message
///
/// An answer is valid if it echoes the IPOC of the message last sent and arrives before the next Step. In a
/// cycle without a valid answer Delay rises; RSI ends when Delay reaches Timeout. With HOLDON, such a cycle
/// uses the last correction again: an absolute correction stays, and a relative one is added to the sum
/// again. Without HOLDON, such a cycle has no correction: with absolute corrections the set point jumps back
/// to the start pose, with relative ones the sum stays.
///
/// RKorr acts along and about the base's axes, at the flange's origin: p = p_start + (X Y Z), R = Rz(A) Ry(B)
/// Rx(C) R_start. Relative corrections are summed element by element. The program's tool frame is the flange,
/// its base frame the robot root.
///
/// If a set point would exceed an axis's speed limit, RSI ends and the arm does not follow it. A real
/// controller (KSS) reacts with "KSS01102 Command velocity".
///
/// **Assumptions.** These are not measured: when exactly a real controller regards an answer as late, what
/// its Delay counts (both ways are implemented), that it never uses a late answer, where exactly it monitors
/// the speed, and lag and dead time of the axes (ServoArm). Only corrections move the arm; the program itself
/// commands no motion. When RSI ends, the set point does not change.
class RsiController {
 public:
  /// @throws std::invalid_argument on a parameter out of range, naming it.
  explicit RsiController(const RsiControllerParams& params);

  /// Accepts one datagram of the PC. Returns true if it answers the message last sent.
  bool Receive(std::span<const std::uint8_t> datagram);

  /// Runs one cycle.
  /// @param client_had_its_time  false if the controller's side itself was late. A missing answer then still
  /// raises Delay, which tells the PC that its answer was missed, but does not count toward Timeout.
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
  /// The reason why the last malformed datagram was rejected.
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
  Six last_{};  // correction in the last valid answer
  SenMessage answer_;
  bool answered_{false};
  std::uint32_t excused_delay_{0};  // part of state_.delay that does not count toward Timeout
  std::uint64_t first_ipoc_;        // first IPOC of this session
  RsiControllerState state_;
  std::string text_, last_error_;
};

}  // namespace osteon::hil
