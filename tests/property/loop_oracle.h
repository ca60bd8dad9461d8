#pragma once

#include <optional>
#include <string>

#include "control/loop/servo_loop.h"
#include "kinematics/lbr_params.h"
#include "safety/zone.h"
#include "tests/property/torque_oracle.h"

// An oracle for the servo loop's commands that shares no code with the loop: the arm's forward kinematics
// from its published Denavit-Hartenberg table, and each limit as a number and an inequality.

namespace osteon::property {

/// The positions of three points of an iiwa 14, in its base B.
struct ArmPoints {
  Vector3 p_elbow_m, p_flange_m, p_tool_m;
  Matrix3 R_flange;  ///< R_BF: orientation of the flange
};
/// Computes the points from the joint angles q [rad] by forward kinematics.
/// Standard Denavit-Hartenberg: d = 0.36 0 0.42 0 0.4 0 0.126 m, a = 0, alpha = -90 90 90 -90 -90 90 0 deg.
/// @param tool_m  distance of the tool's apex along the flange's z
[[nodiscard]] ArmPoints PointsOfIiwa(const control::JointArray& q, double tool_m);

/// The limits that the commands of a generated case must keep. The base is at the world's origin.
struct CaseLimits {
  control::Law law{control::Law::kAdmittance};
  double period_s{0.001};
  std::array<kinematics::JointLimits, 7> joints{};
  double joint_speed_share{0.9};
  double joint_margin_rad{0.0174532925199433};
  double speed_m_per_s{0.25}, turn_rad_per_s{1.5};
  double elbow_speed_m_per_s{0.0};           ///< 0: no bound
  Vector3 sphere_m{Vector3::Zero()};         ///< centre of the sphere that bounds the tool's apex
  double radius_m{1.0}, floor_m{-1.0};       ///< the sphere's radius; lowest z of the apex
  double flange_floor_m{-10.0};              ///< lowest z of the flange's centre
  std::optional<safety::ZoneParams> zone{};  ///< a zone as an additional bound for apex, flange or elbow
  double force_N{200.0}, torque_Nm{20.0};
  const kinematics::ChainParams<7>* body{nullptr};  ///< the arm with its masses; null: no torques are checked
  double spindle_rad_per_s{0.0};
  double tool_m{0.2};
};

/// The requests to a loop since the previous tick.
struct PersonsRequests {
  bool recover{false}, pause{false}, resume{false};
};

/// Checks the inputs and outputs of each tick of a servo loop against the limits of a case.
class LoopOracle {
 public:
  explicit LoopOracle(const CaseLimits& allowed) : allowed_(allowed) {}

  /// Call before the tick, with the tick's inputs.
  void BeforeTick(const control::ServoLoop& loop, const control::ArmState& state,
                  control::ReceiveResult received, const PersonsRequests& asked);
  /// Call after the tick. @returns the violation; empty if there is none
  [[nodiscard]] std::string AfterTick(const control::ServoLoop& loop, const control::TickRecord& record,
                                      const control::ArmCommand& command);

  [[nodiscard]] std::uint64_t rendered_ticks() const { return rendered_; }
  /// Largest speed of the tool so far, as a fraction of the speed limit. It shows how near the cases come to
  /// the limit.
  [[nodiscard]] double most_speed_share() const { return most_speed_; }

 private:
  /// Updates paused_ from the tick's requests. @param read  the tick got a valid message of the arm
  void NotePause(const control::ServoLoop& loop, bool read, const PersonsRequests& asked);
  // Each of the following functions returns the violation that it finds; empty if there is none.
  /// Checks that nothing moves, turns or renders in a pause, after a fault or at a joint's overload.
  [[nodiscard]] std::string CheckStandstill(const control::ServoLoop& loop, const control::TickRecord& record,
                                            const control::ArmCommand& command) const;
  /// Checks the step from the previous command to this one: speeds, ranges of the joints, workspace.
  [[nodiscard]] std::string CheckStep(const control::JointArray& to, control::Phase phase);
  /// Checks the rendered wrench and the overlays on the arm.
  [[nodiscard]] std::string CheckWrenches(const control::TickRecord& record,
                                          const control::ArmCommand& command) const;

  CaseLimits allowed_;
  control::JointArray before_{};             ///< the previous command [rad]
  std::optional<control::JointArray> from_;  ///< joints from which the next command starts; empty: unknown
  control::Phase phase_before_{control::Phase::kWaiting};
  std::uint32_t faults_before_{0};
  bool recovers_{false};         ///< this tick has a request to recover that the loop can fulfil
  bool commanded_{false};        ///< motion began, and the arm has not left the activation since
  std::uint32_t activation_{0};  ///< the arm's activation in which motion began
  TorqueOracle torques_;
  bool overloaded_{false};        ///< a joint will soon exceed its torque
  control::JointArray q_meas_{};  ///< measured [rad] in this tick
  bool reduced_{false};           ///< the arm is in T1: reduced speed
  int reduced_ticks_{0};          ///< consecutive ticks read in T1
  double way_before_m_{0.0};      ///< length of the tool's step in the previous tick
  bool pause_asked_{false};  ///< a pause was requested while the loop moved or waited, and no message of the
                             ///< arm has come since
  bool paused_{false};       ///< a pause was requested, and no resume since
  std::uint64_t rendered_{0};
  double most_speed_{0.0};
};

}  // namespace osteon::property
