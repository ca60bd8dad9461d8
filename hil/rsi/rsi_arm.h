#pragma once

#include "hil/arm_controller.h"
#include "hil/rsi/rsi_controller.h"

namespace osteon::hil {

/// A KR with its controller, and the person at its pad.
struct RsiArmParams {
  RsiControllerParams controller{};  ///< its start_deg is the cell's
  /// Answers of a session before whoever stands at the arm takes it for handed over: those that the PC gives
  /// without a correction (io::RsiSessionParams::settle_messages); >= 1.
  int handed_over_answers{10};
  double start_again_s{1.0};  ///< from the end of RSI to the program's next RSI_ON, where there is one; >= 0
  /// After a Timeout that ended a session with answers the program is started again; without it that takes
  /// another run of the cell.
  bool start_again_after_loss{false};
};

/// A KR over RSI: RsiController, and when its program has RSI on.
///
///     power on ──▶ RSI runs ──Timeout, nobody ever answered──▶ start_again_s ──▶ RSI runs
///                     │ power off, <Stop>, a monitor, Timeout after answers
///                     ▼
///                  RSI has ended: until the power is back after it was off, or by start_again_after_loss
///
/// What stands for FRI's states: IDLE where RSI has ended, MONITORING_WAIT until the first answer,
/// COMMANDING_WAIT for handed_over_answers, then COMMANDING_ACTIVE. Counts go on over sessions. The arm is
/// stiff: what presses on the tool does not deflect it, and its messages say nothing of it.
class RsiArm final : public ArmController {
 public:
  /// @param q_start  [rad], six of them
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
  RsiCounters before_;  // of the sessions before this one
  RsiStopReport last_stop_;
  bool power_{true};
  int idle_cycles_{0};
  std::span<const std::uint8_t> message_;
};

}  // namespace osteon::hil
