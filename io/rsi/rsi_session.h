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

/// Set-up of RSI in the controller's program. The PC cannot query it: the two must agree.
struct RsiSessionParams {
  RsiLayout layout{RsiLayout::kImFree};
  RsiCorrection kind{RsiCorrection::kAxes};
  /// Corrections count from the pose at RSI's start; false: each adds to the sum before.
  bool absolute{true};
  bool hold_on{true};  ///< HOLDON: a cycle without an answer repeats the last correction; false: it has no
                       ///< correction
  int cycle_ms{4};     ///< 4 (IPO_FAST) or 12 (IPO)
  int ipoc_step{4};    ///< increase of IPOC in each cycle: 1, or the cycle's milliseconds; >= 1
  int timeout_cycles{100};  ///< the controller's Timeout: RSI ends after this many late answers; >= 1
  /// Largest distance of each axis from q_start in the first command of an activation; > 0.
  double entry_step_deg{1.0};
  int settle_messages{10};  ///< answered without a correction before the loop may move the arm; >= 1
  /// Largest Delay at which RSI counts as just begun, for set-ups in which the first answers are always lost;
  /// >= 0. A correction left in force by another program would then be a jump.
  int late_at_start{0};
  /// Bound on each correction, in both directions, counted from the start pose [deg; of RKorr mm for X Y Z];
  /// > 0. Set it inside the controller's own range, whose monitor ends RSI.
  std::array<double, 6> range{90.0, 90.0, 90.0, 90.0, 90.0, 90.0};
  int decimals{-1};  ///< of a correction, 0 … 9; -1: RsiDecimals(layout)
  /// Needed for kCartesian: converts joint positions to poses.
  std::optional<kinematics::OrthoParallelParams> arm{};
};

/// Result for a datagram.
enum class RsiAccept : std::uint8_t {
  kAccepted,    ///< newer than all before: its content is in the state
  kDuplicate,   ///< seen before
  kLate,        ///< overtaken by a newer one
  kRejected,    ///< not a valid message; last_error() gives the reason
  kJoinedLate,  ///< RSI was running before this side started: it is never answered, and ends by its Timeout
};

/// State of the session that control::ArmState does not contain. Plain data.
struct RsiStatus {
  std::uint32_t delay{0};         ///< late answers, as counted by the controller
  std::uint32_t sessions{0};      ///< begun so far
  std::uint32_t out_of_range{0};  ///< commands held because a correction was beyond its range
  std::uint32_t not_finite{0};    ///< commands held because they were not finite
  std::uint8_t worst{0};          ///< 1 … 6: the axis (X Y Z A B C) last held for its range; 0: none yet
  std::array<double, 6> sum{};    ///< correction in force [deg; mm, deg], from the start pose
};

/// The PC's side of RSI without the socket: RsiLink drives it in wall time, memory in virtual time.
///
/// Every message is answered once, with its IPOC. The first settle_messages of a session get no correction
/// (the loop sees COMMANDING_WAIT). Then the loop's joint positions become corrections (COMMANDING_ACTIVE):
///
///     absolute   q_cmd - q_start                    q_start: ASPos of the first message, or AIPos
///     relative   q_cmd - q_start - sum              sum: corrections that the controller has added up
///
/// In the relative mode `sum` is made of the numbers as written, so that rounding does not add up. It is
/// corrected when Delay rises: the answer to the message before came too late and was dropped, and HOLDON
/// decides whether the correction before it was added once more for each late cycle.
///
/// Cartesian corrections are those of the flange, about the base's axes at the flange's origin:
///
///     p = p_start + (X Y Z),   R = Rz(A) Ry(B) Rx(C) R_start
///
/// which the configuration of a real controller (reference system, tool) must match.
///
/// The first command that names the activation (control::ArmState) must be within entry_step_deg of q_start;
/// until then the arm is held there.
///
/// RSI's messages do not state their period. Messages are timed from the session's first on. If their
/// interval is at most half or at least twice the configured cycle, ArmState::period_s is the measured
/// interval, in whole milliseconds, from the hand-over on (over at least ten intervals).
///
/// A command that is not finite, or whose correction is beyond its range, is not sent: the last one is held
/// and counted. A session ends if IPOC falls far back or leaps by more than the Timeout, or if nothing came
/// for as long. A session that begins with Delay > late_at_start has been running without us. Its start pose
/// is unknown and a correction could be a jump, so it is not answered. Without the element Delay this cannot
/// be detected; configure it.
///
/// For the loop's seven joints, A7 and external torques are zero, and the interpolator stays at q_start.
/// Allocation-free after construction; one thread at a time.
class RsiSession {
 public:
  /// @throws std::invalid_argument if a parameter is out of range, naming it.
  explicit RsiSession(const RsiSessionParams& params);

  /// Whether the datagram can be read as a message of the controller; changes nothing.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// Takes a datagram that arrived at `stamp`. Always sets the counters of `state`, and the rest only on
  /// kAccepted.
  RsiAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// The datagram that answers the message last accepted; empty if it was already answered. Valid until the
  /// next call. Joint 7 of the command is not used.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// Makes the next answers ask the controller to end RSI (KROSHU's layout); with ImFree they hold the
  /// present correction.
  void RequestStop() OSTEON_RT { stop_ = true; }

  /// Counts the message accepted before the last as late: it was not used, as a newer one was already
  /// waiting.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// Counts a datagram that was refused before it came here, e.g. for its sender.
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
  rt::Nanoseconds last_stamp_{0}, begun_{0};  // of the last message, of the session's first
  double period_ms_{0.0};                     // of this session's messages
  std::uint64_t seen_{0};                     // bit i: IPOC last_ipoc_ - i steps has arrived
  std::uint32_t in_session_{0};               // messages accepted
  std::uint32_t activation_{0};               // number of the present one: ArmState::activation
  bool holding_{false};                       // until the activation's first command was near the start pose
  bool has_last_{false};                      // a message was accepted, so last_ipoc_ and last_stamp_ are set
  bool joined_late_{false};  // RSI was running before this side started: no message is answered
  bool pending_{false};      // the message last accepted is not answered yet
  bool awaiting_{false};     // an answer was sent; the next message's Delay tells whether it came in time
  bool stop_{false};
  Six total_{};       // last correction sent, from the start pose, rounded
  Six sent_{};        // correction as written in the last answer
  Six applied_{};     // the last correction that the controller received in time
  Six sum_before_{};  // relative: the sum without sent_
  RsiStatus status_;
  Counters counters_;
  RsiError last_error_;
  std::array<std::uint8_t, kRsiMaxDatagram> buffer_{};
};

}  // namespace osteon::io
