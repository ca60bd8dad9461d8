#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "control/ports.h"
#include "control/sensing/hand_wrench.h"
#include "hil/arm/simulated_arm.h"
#include "hil/arm_controller.h"
#include "hil/fri_arm.h"
#include "hil/operator/operator_hand.h"
#include "hil/rsi_arm.h"

namespace osteon::hil {

/// Parameters of the simulated cell.
struct SimulatedCellParams {
  /// A KR connected by RSI. Absent: an LBR connected by FRI, with the parameters of the following fields down
  /// to `fri`.
  std::optional<RsiArmParams> kr{};
  kinematics::LbrParams arm{};  ///< no default
  ArmLevel level{ArmLevel::kServo};
  ServoArmParams servo{};
  DynamicArmParams dynamic{};
  /// For the dynamic level: the arm's chain with masses, including sensor and tool.
  kinematics::ChainParams<7> chain{};
  FriServerParams fri{};
  OperatorHandParams hand{};
  PlainPose X_WB{};                     ///< pose of the robot's base in the world
  PlainPose X_FT{};                     ///< pose of the tool in the flange's frame
  control::ForceSensorParams sensor{};  ///< the sensor between flange and tool
  /// For an LBR of level kServo or kDynamic: the sensor's load includes the tool's inertial force, as for a
  /// real sensor.
  bool sensor_feels_inertia{false};
  control::JointArray q_start{};  ///< [rad]; a KR uses the first six
};

/// Returns the parameters of the LBR only. @pre params.kr is absent
[[nodiscard]] SimulatedArmParams BodyOf(const SimulatedCellParams& params);

/// State of the cell after a step. Plain data.
struct CellState : ArmStatus {
  std::uint64_t cycle{0};
  rt::Nanoseconds stamp{0};
  bool active_once{false};  ///< COMMANDING_ACTIVE was reached at least once
  double cell_time_s{0.0};  ///< time of the script: since the hand last took hold, counted in periods
  bool script_done{false};
  control::JointArray q_meas{}, q_cmd{};  ///< [rad]
  PlainPose X_WT_meas;
  PlainVector3 v_WT_meas_m_per_s, w_WT_meas_rad_per_s;  ///< velocity of T, in W
  PlainWrench F_hand_T_W;  ///< wrench that the hand exerts on the tool, at T's origin, in W
  /// Load of the force sensor, at S's origin, in S: from the hand's wrench and the tool's weight, and from
  /// the tool's inertial force if sensor_feels_inertia.
  PlainWrench F_S;
};

/// Simulates the arm and the operator of a cell, and the load on its force sensor, in lockstep: one Step()
/// per period. It converts received bytes to bytes to send. The same code runs in wall time
/// (SimulatedCellThread) and in virtual time. Two runs with the same input send the same bytes.
///
/// An ArmController simulates arm and controller for FRI or RSI. ArmLevel says how much of the arm is
/// modelled. At levels kKinematic and kServo the hand's wrench does not deflect the arm; it reaches the
/// client only through the sensor. The cell contains no bone: under the admittance law the contact is
/// virtual, and the arm's motion renders it to the hand. A flexible mount moves the tool, but its velocity is
/// not part of the tool's velocity that the hand's model gets.
///
/// The hand takes hold of the tool when COMMANDING_ACTIVE has begun and the tool has arrived at the script's
/// start: the tool is within 3 mm and 0.03 rad of the start, or has been at rest for 0.3 s within 30 mm and
/// 0.3 rad. Before that, the hand does not touch the tool, because the arm is on its start path. The hand
/// lets go when COMMANDING_ACTIVE ends. After the first hold it takes hold again at any pose of the tool.
class SimulatedCell {
 public:
  /// Opens the session. @throws std::invalid_argument from the arm, the operator or the script, on a
  /// parameter out of range.
  SimulatedCell(const SimulatedCellParams& params, HandScript script);

  /// Accepts one datagram of the client. Returns true if it answers the present message.
  bool Receive(std::span<const std::uint8_t> datagram) { return arm_->Receive(datagram); }

  /// Advances by one period: the client's answer, the arm, the hand, the sensor, the next message.
  /// @param now time of the message and of the sensor's reading; >= 0.
  /// @param client_had_its_time false if the arm's side itself was late: a missing answer is then not counted
  /// as the client's loss.
  /// @returns the datagram to send, valid until the next call; empty once the session is closed.
  std::span<const std::uint8_t> Step(rt::Nanoseconds now, bool client_had_its_time = true);

  [[nodiscard]] const CellState& state() const { return state_; }
  /// See ArmController.
  void SetPower(bool on) { arm_->SetPower(on); }
  /// See ArmController.
  [[nodiscard]] bool EndSession() { return arm_->EndSession(); }

  /// Returns the arm's side of an FRI session, for actions of the robot's program and its operator.
  /// @throws std::bad_cast if the arm is connected by RSI.
  [[nodiscard]] FriServer& server() { return dynamic_cast<FriArm&>(*arm_).server(); }
  /// Returns the reading of an ideal force sensor.
  [[nodiscard]] control::ForceReading force() const { return {.stamp = state_.stamp, .F_S = state_.F_S}; }
  [[nodiscard]] double period_s() const { return arm_->period_s(); }
  [[nodiscard]] const HandScript& script() const { return hand_.script(); }

 private:
  // Updates the time for which the tool has been at rest near the script's start. @returns whether the tool
  // has arrived
  [[nodiscard]] bool UpdateArrival(const Pose& X_WT, const Twist& V_WT);

  Pose X_WB_, X_TF_;
  control::ForceSensorParams sensor_;
  bool feels_inertia_, has_twist_{false};
  Twist V_WT_before_;
  std::unique_ptr<ArmController> arm_;
  Wrench F_hand_T_B_;
  OperatorHand hand_;
  // whether the hand holds the tool now, and whether it has held it before
  bool holds_{false}, held_once_{false};
  double idle_s_{0.0};  // time for which the tool has been at rest near the script's start
  std::uint64_t held_cycles_{0};
  CellState state_;
};

}  // namespace osteon::hil
