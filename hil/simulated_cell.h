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
  /// A KR over RSI. Absent: an LBR over FRI, which the fields down to `fri` describe.
  std::optional<RsiArmParams> kr{};
  kinematics::LbrParams arm{};  ///< no default
  ArmLevel level{ArmLevel::kServo};
  ServoArmParams servo{};
  DynamicArmParams dynamic{};
  kinematics::ChainParams<7> chain{};  ///< of the dynamic level: the arm with masses, sensor and tool
  FriServerParams fri{};
  OperatorHandParams hand{};
  PlainPose X_WB{};                     ///< robot base in world
  PlainPose X_FT{};                     ///< tool in flange
  control::ForceSensorParams sensor{};  ///< between flange and tool
  /// For an LBR on kServo or kDynamic: the sensor also carries the tool's inertia, as a real one does.
  bool sensor_feels_inertia{false};
  control::JointArray q_start{};  ///< [rad]; a KR uses the first six
};

/// Parameters of the LBR alone. @pre no kr
[[nodiscard]] SimulatedArmParams BodyOf(const SimulatedCellParams& params);

/// State of the cell after a step. Plain data.
struct CellState : ArmStatus {
  std::uint64_t cycle{0};
  rt::Nanoseconds stamp{0};
  bool active_once{false};  ///< COMMANDING_ACTIVE was reached
  double cell_time_s{0.0};  ///< since the hand last took hold, counted in periods: the script's time
  bool script_done{false};
  control::JointArray q_meas{}, q_cmd{};  ///< [rad]
  PlainPose X_WT_meas;
  PlainVector3 v_WT_meas_m_per_s, w_WT_meas_rad_per_s;  ///< velocity of T, in W
  PlainWrench F_hand_T_W;  ///< what the hand exerts on the tool, at T's origin, in W
  /// Load of the force sensor, at S's origin, in S: the hand's wrench and the tool's weight (and inertia, if
  /// sensor_feels_inertia).
  PlainWrench F_S;
};

/// Arm and operator of the cell, and the load on its force sensor, in lockstep: one Step() a period, bytes in
/// and bytes out. The same code runs in wall time (SimulatedCellThread) and in virtual time. Two runs with
/// the same input give the same bytes.
///
/// Arm and controller are an ArmController for either protocol. ArmLevel says how much of the arm is
/// modelled. Up to kServo the arm is stiff against the hand, whose wrench reaches the client through the
/// sensor alone. There is no bone here: in admittance the contact is virtual, and the hand feels it as the
/// arm's motion. A flexible mount moves the tool, but the hand does not feel its speed.
///
/// The hand takes hold when COMMANDING_ACTIVE has begun and the tool has arrived at the script's start: it is
/// within 3 mm and 0.03 rad of it, or has stood still for 0.3 s within 30 mm and 0.3 rad. Until then the hand
/// leaves the arm alone, which is on its start path. It lets go when COMMANDING_ACTIVE ends. After its first
/// hold it takes hold again wherever the tool is.
class SimulatedCell {
 public:
  /// Opens the session. @throws std::invalid_argument from the parts, on a parameter out of range.
  SimulatedCell(const SimulatedCellParams& params, HandScript script);

  /// Takes one datagram of the client. True if it answers the current message.
  bool Receive(std::span<const std::uint8_t> datagram) { return arm_->Receive(datagram); }

  /// Advances by one period: the client's answer, the arm, the hand, the sensor, the next message.
  /// @param now time of the message and of the sensor's reading; >= 0.
  /// @param client_had_its_time false if this side was late: a missing answer is then not counted against the
  ///   client.
  /// @returns the datagram to send, valid until the next call; empty once the session is closed.
  std::span<const std::uint8_t> Step(rt::Nanoseconds now, bool client_had_its_time = true);

  [[nodiscard]] const CellState& state() const { return state_; }
  /// See ArmController.
  void SetPower(bool on) { arm_->SetPower(on); }
  /// See ArmController.
  [[nodiscard]] bool EndSession() { return arm_->EndSession(); }

  /// The arm's side of an FRI session, for actions of the robot's program and its operator.
  /// @throws std::bad_cast if the arm speaks RSI.
  [[nodiscard]] FriServer& server() { return dynamic_cast<FriArm&>(*arm_).server(); }
  /// The sensor's load as an ideal sensor would read it.
  [[nodiscard]] control::ForceReading force() const { return {.stamp = state_.stamp, .F_S = state_.F_S}; }
  [[nodiscard]] double period_s() const { return arm_->period_s(); }
  [[nodiscard]] const HandScript& script() const { return hand_.script(); }

 private:
  // Counts how long the tool has stood near the script's start. @returns whether it has arrived there
  [[nodiscard]] bool UpdateArrival(const Pose& X_WT, const Twist& V_WT);

  Pose X_WB_, X_TF_;
  control::ForceSensorParams sensor_;
  bool feels_inertia_, has_twist_{false};
  Twist V_WT_before_;
  std::unique_ptr<ArmController> arm_;
  Wrench F_hand_T_B_;
  OperatorHand hand_;
  bool holds_{false}, held_once_{false};  // whether the hand holds, or has held, the tool
  double idle_s_{0.0};                    // time that the tool has stood within the operator's reach
  std::uint64_t held_cycles_{0};
  CellState state_;
};

}  // namespace osteon::hil
