#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "control/loop/servo_loop.h"
#include "hil/arm/servo_arm.h"
#include "kinematics/lbr_arm.h"
#include "safety/cell_state.h"

// The simulated cell of the fault matrix: the servo loop on a simulated arm with lag, a drive, a PLC, a hand
// and a plane of bone, in virtual time.

namespace osteon::studies {

/// Inputs of a tick, as the cell's devices give them. An injection may change them before the loop gets them.
struct RigInputs {
  control::ArmState arm;
  control::ReceiveResult received{control::ReceiveResult::kOk};
  control::CellReadings readings;
  simulation::ContactModel model;
  rt::Nanoseconds now{0};
};

class FaultRig;
/// Changes the inputs of one tick, or the rig itself, to inject a fault.
/// @param since  ticks since the injection began, from 0
using RigInjection = std::function<void(RigInputs& inputs, int since, FaultRig& rig)>;

/// Records every tick.
class RigRecorder final : public control::TickRecorder {
 public:
  bool Push(const control::TickRecord& record) OSTEON_RT override {
    ++pushed;
    records.push_back(record);
    return true;
  }
  [[nodiscard]] bool Stalled() const OSTEON_RT override { return stalled; }
  std::vector<control::TickRecord> records;
  std::uint64_t pushed{0};
  bool stalled{false};
};

/// The cell with its servo loop; see the top of this file.
class FaultRig {
 public:
  static constexpr rt::Nanoseconds kTick = rt::kMillisecond;
  enum class StartPath { kNone, kToStart };

  /// The servo loop's parameters, the same for every run: the shipped limits, and a start path if requested.
  [[nodiscard]] static control::ServoParams Params(StartPath start_path);
  [[nodiscard]] static kinematics::JointVector StartJoints();

  explicit FaultRig(StartPath start_path = StartPath::kNone,
                    const kinematics::JointVector& q = StartJoints());

  /// Brings the cell into a state, as a user would.
  /// @throws std::logic_error if the cell does not reach the state.
  void BringTo(safety::CellState state);
  /// Runs one tick, with an injection if there is one, and returns the tick's record.
  const control::TickRecord& Tick(const RigInjection& inject = {}, int since = 0);
  void Run(int ticks);
  /// Hands the arm over to the loop, from another session state; this begins a new activation.
  void HandOver();
  /// Takes the arm back from the loop.
  void TakeBack() { session_ = control::SessionState::kCommandingWait; }

  [[nodiscard]] control::ServoLoop& loop() { return loop_; }
  [[nodiscard]] const control::ServoLoop& loop() const { return loop_; }
  [[nodiscard]] const kinematics::JointVector& q() const { return arm_.q(); }
  [[nodiscard]] const kinematics::JointVector& qd() const { return arm_.qd(); }
  [[nodiscard]] RigRecorder& recorder() { return recorder_; }
  [[nodiscard]] const control::TickRecord& last() const { return last_; }
  [[nodiscard]] const Vector3& feed_W() const { return feed_W_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  [[nodiscard]] control::ArmCommand command() const { return command_; }

  bool permitted{true};              ///< the PLC permits motion
  double spindle_rad_per_s{25.0};    ///< speed while the spindle is commanded to turn
  double push_N{40.0}, side_N{3.0};  ///< force of the hand along the feed and across it
  rt::Nanoseconds clock_offset{0};   ///< offset of the loop's clock; a change acts from the next tick on

 private:
  /// The measured tool pose X_WT.
  [[nodiscard]] Pose ToolNow() const;
  [[nodiscard]] RigInputs Inputs();
  void Simulate(rt::Nanoseconds now);

  kinematics::LbrArm kinematics_;
  hil::ServoArm arm_;
  control::ServoLoop loop_;
  RigRecorder recorder_;
  Vector3 feed_W_, side_W_, plane_W_;       ///< plane_W_: a point on the plane [m]
  kinematics::JointVector q_told_, q_ipo_;  ///< joints that the arm follows; joints at the hand-over
  control::SessionState session_{control::SessionState::kCommandingWait};
  std::uint32_t activation_{0}, sequence_{0};
  control::ArmCommand command_;
  simulation::ContactModel model_;
  control::TickRecord last_;
  rt::Nanoseconds time_{rt::kSecond};
  std::uint64_t ticks_{0};
};

}  // namespace osteon::studies
