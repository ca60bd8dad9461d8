#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "control/ports.h"
#include "io/rsi/codec.h"
#include "kinematics/ortho_parallel_params.h"
#include "kinematics/serial_chain.h"

namespace osteon::io {

/// Set-up of RSI in the controller's program. The PC cannot query it, so these parameters must be set to the
/// same values.
struct RsiSessionParams {
  RsiLayout layout{RsiLayout::kImFree};
  RsiCorrection kind{RsiCorrection::kAxes};
  /// true: corrections count from the pose at RSI's start; false: each correction is added to the sum of
  /// those before.
  bool absolute{true};
  bool hold_on{true};       ///< HOLDON. true: in a cycle without an answer the controller repeats the last
                            ///< correction; false: it applies none
  int cycle_ms{4};          ///< 4 (IPO_FAST) or 12 (IPO)
  int ipoc_step{4};         ///< increase of IPOC in each cycle: 1, or the cycle's milliseconds; >= 1
  int timeout_cycles{100};  ///< the controller's Timeout: RSI ends after this many late answers; >= 1
  /// Largest distance of each axis from q_start that the first command of an activation may have; > 0.
  double entry_step_deg{1.0};
  /// number of messages answered without a correction before the loop may move the arm; >= 1
  int settle_messages{10};
  /// Largest Delay in a session's first message at which RSI counts as just begun; >= 0. Raise it only for
  /// set-ups in which the first answers are always lost: if another program had left a correction in force,
  /// our first correction would be a jump.
  int late_at_start{0};
  /// Largest magnitude of each correction from the start pose [deg; X Y Z of RKorr: mm]; > 0. Set it below
  /// the controller's own limit, because beyond that limit the controller ends RSI.
  std::array<double, 6> range{90.0, 90.0, 90.0, 90.0, 90.0, 90.0};
  int decimals{-1};  ///< of a correction, 0 … 9; -1: RsiDecimals(layout)
  /// Needed for kCartesian: converts joint positions to poses.
  std::optional<kinematics::OrthoParallelParams> arm{};
};

/// Result for a datagram.
enum class RsiAccept : std::uint8_t {
  kAccepted,    ///< newer than all messages before; its content was written to the state
  kDuplicate,   ///< received before
  kLate,        ///< overtaken by a newer one
  kRejected,    ///< not a valid message; last_error() gives the reason
  kJoinedLate,  ///< RSI was running before this side started: the session is never answered, and ends by the
                ///< controller's Timeout
};

/// State of the session that control::ArmState does not contain. Plain data.
struct RsiStatus {
  std::uint32_t delay{0};         ///< number of late answers, as counted by the controller
  std::uint32_t sessions{0};      ///< number of sessions begun so far
  std::uint32_t out_of_range{0};  ///< commands not sent, because a correction was beyond its range
  std::uint32_t not_finite{0};    ///< commands not sent, because they were not finite
  std::uint8_t worst{0};  ///< 1 … 6: the axis (or X Y Z A B C) that was last beyond its range; 0: none yet
  std::array<double, 6> sum{};  ///< correction in force, from the start pose [deg, or mm and deg for RKorr]
};

/// The PC's side of RSI without the socket: RsiLink passes it datagrams in wall time, the simulated cell in
/// virtual time.
///
/// Every message is answered once, with its IPOC. The first settle_messages of a session get no correction
/// (the loop sees COMMANDING_WAIT). Then the loop's joint positions become corrections (COMMANDING_ACTIVE):
///
///     absolute   q_cmd - q_start                    q_start: ASPos of the first message, or AIPos
///     relative   q_cmd - q_start - sum              sum: corrections that the controller has added up
///
/// In the relative mode `sum` adds the rounded numbers that were sent, so that rounding errors do not
/// accumulate. A rise of Delay means that the answer to the message before came too late and was dropped.
/// That answer is then removed from `sum`. With HOLDON the controller has repeated the last correction it
/// received in time, so that correction is added once for each late cycle.
///
/// Cartesian corrections move the flange: X Y Z along the base's axes, A B C about the base's axes through
/// the flange's origin:
///
///     p = p_start + (X Y Z),   R = Rz(A) Ry(B) Rx(C) R_start
///
/// The configuration of a real controller (reference system, tool) must match this.
///
/// The first command that names the activation (control::ArmState) must be within entry_step_deg of q_start;
/// until then the arm stays at q_start.
///
/// RSI's messages do not state their period. The session measures the mean interval between messages, over at
/// least ten intervals from its first message on. If the mean is at most half or at least twice the
/// configured cycle, ArmState::period_s is the mean, in whole milliseconds, from the end of settling on.
///
/// A command that is not finite, or whose correction is beyond its range, is not sent: the last correction is
/// repeated, and the event is counted. A session ends if IPOC falls back by 64 steps or more, if IPOC rises
/// by more steps than the Timeout has cycles, or if no message came during the Timeout. A session that begins
/// with Delay > late_at_start was running before this side started. Its start pose is unknown and a
/// correction could be a jump, so its messages are not answered. Without the element Delay this cannot be
/// detected, so the controller's configuration should contain it.
///
/// The loop's state has seven joints: A7 and all external torques are zero, and the interpolator's position
/// is always q_start. Allocation-free after construction; one thread at a time.
class RsiSession {
 public:
  /// @throws std::invalid_argument if a parameter is out of range, naming it.
  explicit RsiSession(const RsiSessionParams& params);

  /// Whether the datagram is a valid message of the controller; changes nothing.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// Processes a datagram that arrived at `stamp`. Always sets the counters of `state`, and the rest only on
  /// kAccepted.
  RsiAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// Makes the datagram that answers the message last accepted; empty if that message was already answered.
  /// Valid until the next call. Joint 7 of the command is not used.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// Makes the next answers ask the controller to end RSI (KROSHU's layout); with ImFree they hold the
  /// present correction.
  void RequestStop() OSTEON_RT { stop_ = true; }

  /// Counts a message as late that was accepted but not used, because a newer one was already waiting.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// Counts a datagram that the caller refused, e.g. because of its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// Lets the next message begin a session, whatever its IPOC; the counts continue.
  void ResetSession() OSTEON_RT { has_last_ = pending_ = false; }

  [[nodiscard]] const RsiStatus& status() const OSTEON_RT { return status_; }
  /// Why the last kRejected datagram was refused.
  [[nodiscard]] const RsiError& last_error() const OSTEON_RT { return last_error_; }

 private:
  enum class Order : std::uint8_t { kFirst, kNext, kDuplicate, kLate };
  // @param ahead  set with kNext: cycles since the message before
  Order CheckSequence(std::uint64_t ipoc, rt::Nanoseconds stamp, std::uint32_t& ahead) OSTEON_RT;
  bool TooLate(const RsiRobotMessage& first) const OSTEON_RT;
  double Period_s(rt::Nanoseconds stamp) OSTEON_RT;
  void BeginSession(const RsiRobotMessage& message) OSTEON_RT;
  void PutMessage(const RsiRobotMessage& message, rt::Nanoseconds stamp, control::ArmState& state) OSTEON_RT;
  void TrackCorrectionSum(std::uint32_t ahead, std::uint32_t delay) OSTEON_RT;
  bool MayMove(const control::ArmCommand& command) OSTEON_RT;
  bool ComputeCorrection(const control::ArmCommand& command, std::array<double, 6>& correction) OSTEON_RT;
  void PutCounters(control::ArmState& state) const OSTEON_RT;

  struct Counters {
    std::uint32_t lost{0}, duplicate{0}, late{0}, reordered{0}, rejected{0};
  };
  using Six = std::array<double, 6>;

  RsiSessionParams params_;
  int decimals_;
  std::optional<kinematics::SerialChain<6>> chain_;
  Pose X_BF_start_{Pose::Identity()};
  RsiAxes start_deg_{};
  std::uint64_t last_ipoc_{0};
  std::uint8_t ipoc_digits_{0};
  rt::Nanoseconds last_stamp_{0}, begun_{0};  // arrival of the last message, and of the session's first
  double period_ms_{0.0};                     // period of this session's messages
  std::uint64_t seen_{0};                     // bit i: IPOC last_ipoc_ - i steps has arrived
  std::uint32_t in_session_{0};               // number of messages accepted in this session
  std::uint32_t activation_{0};               // number of the present activation: ArmState::activation
  bool holding_{false};      // the activation's first command has not yet been near the start pose
  bool has_last_{false};     // a message was accepted, so last_ipoc_ and last_stamp_ are set
  bool joined_late_{false};  // RSI was running before this side started: no message is answered
  bool pending_{false};      // the message last accepted is not answered yet
  bool awaiting_{false};     // an answer was sent; the next message's Delay tells whether it came in time
  bool stop_{false};
  Six total_{};       // last correction sent, from the start pose, rounded
  Six sent_{};        // correction as sent in the last answer
  Six applied_{};     // the last correction that the controller received in time
  Six sum_before_{};  // relative mode: the sum before sent_ was added
  RsiStatus status_;
  Counters counters_;
  RsiError last_error_;
  std::array<std::uint8_t, kRsiMaxDatagram> buffer_{};
};

}  // namespace osteon::io
