#pragma once

#include "hil/arm_controller.h"
#include "hil/rsi/rsi_controller.h"

namespace osteon::hil {

/// Parameters of a KR with its controller, and of the operator at its pad.
struct RsiArmParams {
  RsiControllerParams controller{};  ///< the cell sets its start_deg
  /// Number of answers in a session after which the arm counts as handed over; >= 1. It should equal the
  /// number of answers that the PC sends without a correction (io::RsiSessionParams::settle_messages).
  int handed_over_answers{10};
  /// Time from the end of RSI to the program's next RSI_ON, if the program is started again; >= 0.
  double start_again_s{1.0};
  /// True: the program also restarts after a Timeout that ended a session with answers. False: after such a
  /// Timeout, the cell must be started again.
  bool start_again_after_loss{false};
};

/// A KR connected by RSI: RsiController, and the robot program that turns RSI on.
///
///     power on ──▶ RSI runs ──Timeout, nobody ever answered──▶ start_again_s ──▶ RSI runs
///                     │ power off, <Stop>, a monitor, Timeout after answers
///                     ▼
///                  RSI has ended, until the power is switched off and on, or until the restart by start_again_after_loss
///
/// The arm reports equivalents of FRI's states: IDLE after RSI has ended, MONITORING_WAIT until the first
/// answer, COMMANDING_WAIT for handed_over_answers, then COMMANDING_ACTIVE. Counters continue over sessions.
/// The arm is stiff: a wrench on the tool does not deflect it, and its messages do not contain the wrench.
class RsiArm final : public ArmController {
 public:
  /// @param q_start  start position of the joints [rad]; the first six are used
  /// @throws std::invalid_argument on a parameter out of range, naming it.
  RsiArm(const RsiArmParams& params, const control::JointArray& q_start, const Pose& X_FT);

  bool Receive(std::span<const std::uint8_t> datagram) override { return controller_.Receive(datagram); }
  void Move(bool client_had_its_time, const Wrench& F_T_B) override;
  [[nodiscard]] std::span<const std::uint8_t> Message(const Wrench& F_T_T, rt::Nanoseconds now) override;
  void SetPower(bool on) override;
  [[nodiscard]] ArmMotion motion() const override;
  [[nodiscard]] ArmStatus status() const override;
  [[nodiscard]] double period_s() const override { return controller_.period_s(); }

  [[nodiscard]] const RsiController& controller() const { return controller_; }

 private:
  [[nodiscard]] bool StartsAgain() const;
  void Restart();

  RsiArmParams params_;
  Pose X_FT_;
  RsiController controller_;
  kinematics::OrthoParallelArm arm_;
  RsiCounters before_;  // counters of all earlier sessions
  RsiStopReport last_stop_;
  bool power_{true};
  int idle_cycles_{0};  // number of cycles since RSI ended
  std::span<const std::uint8_t> message_;
};

}  // namespace osteon::hil
