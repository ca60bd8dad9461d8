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

/// How the controller's program has set RSI up. The PC cannot ask: the two have to agree.
struct RsiSessionParams {
  RsiLayout layout{RsiLayout::kImFree};
  RsiCorrection kind{RsiCorrection::kAxes};
  bool absolute{
      true};           ///< corrections count from the pose at RSI's start; false: each adds to the sum before
  bool hold_on{true};  ///< HOLDON: a cycle without an answer repeats the last correction; false: it has none
  int cycle_ms{4};     ///< 4 (IPO_FAST) or 12 (IPO)
  int ipoc_step{4};    ///< by which IPOC grows each cycle: 1, or the cycle's milliseconds; >= 1
  int timeout_cycles{100};  ///< the controller's Timeout: after so many late answers RSI has ended; >= 1
  double entry_step_deg{
      1.0};                 ///< the first command of an activation may be so far off q_start, each axis; > 0
  int settle_messages{10};  ///< answered with no correction before the loop may move the arm; >= 1
  /// Delay that RSI may begin with and still count as just begun, where the first answers are always lost; >=
  /// 0. A correction that another program had in force before would then be a jump.
  int late_at_start{0};
  /// Bound on each correction, either way, counted from the start pose [deg; of RKorr mm for X Y Z]; > 0. Set
  /// it inside of the controller's own, whose monitor ends RSI.
  std::array<double, 6> range{90.0, 90.0, 90.0, 90.0, 90.0, 90.0};
  int decimals{-1};  ///< of a correction, 0 … 9; -1: RsiDecimals(layout)
  /// Needed where kind is kCartesian: joint positions become poses by it.
  std::optional<kinematics::OrthoParallelParams> arm{};
};

/// What became of a datagram.
enum class RsiAccept : std::uint8_t {
  kAccepted,    ///< newer than all before: the state is its content
  kDuplicate,   ///< seen before
  kLate,        ///< overtaken by a newer one
  kRejected,    ///< not a valid message; last_error() says why
  kJoinedLate,  ///< RSI was running before this side was there: it is never answered, and ends by its Timeout
};

/// What the session knows beside control::ArmState. Plain data.
struct RsiStatus {
  std::uint32_t delay{0};         ///< late answers, as the controller says
  std::uint32_t sessions{0};      ///< begun so far
  std::uint32_t out_of_range{0};  ///< commands held as a correction was beyond its range
  std::uint32_t not_finite{0};    ///< commands held as they were not finite
  std::uint8_t worst{0};          ///< 1 … 6: the axis (X Y Z A B C) last held for its range; 0: none yet
  std::array<double, 6> sum{};    ///< correction in force [deg; mm, deg], from the start pose
};

/// The PC's side of RSI, all of it but the socket: wall time drives it through RsiLink, virtual time through
/// memory.
///
/// Every message is answered once, with its IPOC. The first settle_messages of a session get no correction
/// (COMMANDING_WAIT to the loop), then the loop's joint positions become corrections (COMMANDING_ACTIVE):
///
///     absolute   q_cmd - q_start                    q_start: ASPos of the first message, or AIPos
///     relative   q_cmd - q_start - sum, sum: what the controller has added up so far
///
/// In the relative mode `sum` is made of the numbers as written, so that rounding does not add up, and is put
/// right where Delay rises: the answer to the message before came too late and was dropped, and by HOLDON the
/// correction before it was added once more for each late cycle, or not.
///
/// Cartesian corrections are those of the flange, about the base's axes at the flange's origin:
///
///     p = p_start + (X Y Z),   R = Rz(A) Ry(B) Rx(C) R_start
///
/// which a real controller's configuration (reference system, tool) has to match.
///
/// The first command that names the activation (control::ArmState) has to be within entry_step_deg of
/// q_start; until then the arm is held there.
///
/// RSI's messages do not say their period. They are timed from the session's first on: where they come at
/// half the configured cycle or less, or at twice or more, ArmState::period_s is what they come at, in whole
/// milliseconds, from the hand-over on (of at least ten intervals).
///
/// A command that is not finite, or whose correction is beyond its range, is not sent: the last one is held
/// and counted. A session ends where IPOC falls far back, leaps by more than the Timeout, or nothing came for
/// as long. One that begins with Delay > late_at_start has been running without us, so that its start pose is
/// not known and a correction could be a jump: it is not answered. Without the element Delay nobody can tell;
/// configure it.
///
/// To the loop's seven joints: A7 is zero, external torques are zero, the interpolator rests at q_start.
/// Allocation-free after construction; one thread at a time.
class RsiSession {
 public:
  /// @throws std::invalid_argument where a parameter is out of range, naming it.
  explicit RsiSession(const RsiSessionParams& params);

  /// It can be read as a message of the controller; nothing is changed by looking.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// Takes a datagram that arrived at `stamp`. The counters of `state` are always set, the rest on kAccepted
  /// only.
  RsiAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// The datagram that answers the message last accepted; empty where it was answered before. Valid until the
  /// next call. Joint 7 of the command is nobody's.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// The answers to come ask the controller to end RSI (KROSHU's layout); with ImFree they hold where they
  /// are.
  void RequestStop() OSTEON_RT { stop_ = true; }

  /// The message accepted before the last was never looked at: a newer one was already waiting behind it.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// A datagram was refused before it came here, e.g. for its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// The next message begins a session, whatever its IPOC; the counts go on.
  void StartOver() OSTEON_RT { has_last_ = pending_ = false; }

  [[nodiscard]] const RsiStatus& status() const OSTEON_RT { return status_; }
  /// Why the last kRejected datagram was refused.
  [[nodiscard]] const RsiError& last_error() const OSTEON_RT { return last_error_; }

 private:
  enum class Order : std::uint8_t { kFirst, kNext, kDuplicate, kLate };
  // @param ahead  set with kNext: cycles since the message before
  Order CheckSequence(std::uint64_t ipoc, rt::Nanoseconds stamp, std::uint32_t& ahead) OSTEON_RT;
  bool TooLate(const RsiRobotMessage& first) const OSTEON_RT;
  double Period_s(rt::Nanoseconds stamp) OSTEON_RT;
  void Begin(const RsiRobotMessage& message) OSTEON_RT;
  void FollowSum(std::uint32_t ahead, std::uint32_t delay) OSTEON_RT;
  bool MayMove(const control::ArmCommand& command) OSTEON_RT;
  bool Wanted(const control::ArmCommand& command, std::array<double, 6>& correction) OSTEON_RT;
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
  std::uint32_t activation_{0};               // of control::ArmState
  bool holding_{false};
  bool has_last_{false};
  bool joined_late_{false};
  bool pending_{false};   // the message last accepted is not answered yet
  bool awaiting_{false};  // an answer was sent; the next message's Delay says whether it came in time
  bool stop_{false};
  Six total_{};       // correction from the start pose that was last sent, rounded
  Six sent_{};        // as written in that answer
  Six applied_{};     // the last that the controller took in time
  Six sum_before_{};  // relative: the sum without sent_
  RsiStatus status_;
  Counters counters_;
  RsiError last_error_;
  std::array<std::uint8_t, kRsiMaxDatagram> buffer_{};
};

}  // namespace osteon::io
