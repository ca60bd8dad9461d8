#pragma once

#include <optional>
#include <string>

#include "control/loop/servo_loop.h"
#include "kinematics/lbr_params.h"
#include "safety/zone.h"
#include "tests/property/torque_oracle.h"

// What a servo loop may command, computed independently of it: an arm's forward kinematics from its published
// Denavit-Hartenberg table, and each limit as a number and an inequality.

namespace osteon::property {

/// The positions of three points of an iiwa 14, in its base B.
struct ArmPoints {
  Vector3 p_elbow_m, p_flange_m, p_tool_m;
  Matrix3 R_flange;
};
/// Standard Denavit-Hartenberg: d = 0.36 0 0.42 0 0.4 0 0.126 m, a = 0, alpha = -90 90 90 -90 -90 90 0 deg.
/// @param tool_m  distance of the tool's apex along the flange's z
[[nodiscard]] ArmPoints PointsOfIiwa(const control::JointArray& q, double tool_m);

/// The limits of a case. The base is at the world's origin.
struct Allowed {
  control::Law law{control::Law::kAdmittance};
  double period_s{0.001};
  std::array<kinematics::JointLimits, 7> joints{};
  double joint_speed_share{0.9};
  double joint_margin_rad{0.0174532925199433};
  double speed_m_per_s{0.25}, turn_rad_per_s{1.5};
  double elbow_speed_m_per_s{0.0};  ///< 0: no bound
  Vector3 sphere_m{Vector3::Zero()};
  double radius_m{1.0}, floor_m{-1.0};       ///< for the apex
  double flange_floor_m{-10.0};              ///< for the flange's centre
  std::optional<safety::ZoneParams> zone{};  ///< one more bound, for apex, flange or elbow
  double force_N{200.0}, torque_Nm{20.0};
  const kinematics::ChainParams<7>* body{nullptr};  ///< with its masses; null: its torques are not known
  double spindle_rad_per_s{0.0};
  double tool_m{0.2};
};

/// The requests to a loop since the previous tick.
struct Asked {
  bool recover{false}, pause{false}, resume{false};
};

/// Checks each tick of a loop from outside.
class LoopOracle {
 public:
  explicit LoopOracle(const Allowed& allowed) : allowed_(allowed) {}

  /// Call before the tick, with the tick's inputs.
  void Before(const control::ServoLoop& loop, const control::ArmState& state, control::ReceiveResult received,
              const Asked& asked);
  /// Call after the tick. @returns the violation; empty if there is none
  [[nodiscard]] std::string After(const control::ServoLoop& loop, const control::TickRecord& record,
                                  const control::ArmCommand& command);

  [[nodiscard]] std::uint64_t rendered_ticks() const { return rendered_; }
  /// The greatest fraction of a limit that was reached, 1 at a limit: shows what was really tested.
  [[nodiscard]] double most_speed_share() const { return most_speed_; }

 private:
  void NotePause(const control::ServoLoop& loop, bool read, const Asked& asked);
  [[nodiscard]] std::string Stands(const control::ServoLoop& loop, const control::TickRecord& record,
                                   const control::ArmCommand& command) const;
  [[nodiscard]] std::string Motion(const control::JointArray& to, control::Phase phase);
  [[nodiscard]] std::string Wrenches(const control::TickRecord& record,
                                     const control::ArmCommand& command) const;

  Allowed allowed_;
  control::JointArray before_{};
  std::optional<control::JointArray> from_;  ///< start of the next command; nothing: anywhere
  control::Phase phase_before_{control::Phase::kWaiting};
  std::uint32_t faults_before_{0};
  bool recovers_{false};
  bool commanded_{false};        ///< motion began, and the arm has not left the activation since
  std::uint32_t activation_{0};  ///< at that time
  TorqueOracle torques_;
  bool overloaded_{false};        ///< a joint will soon exceed its torque
  control::JointArray q_meas_{};  ///< measured [rad] in this tick
  bool reduced_{false};
  int reduced_ticks_{0};      ///< consecutive ticks read in T1
  double way_before_m_{0.0};  ///< of the tool, in the previous tick
  bool pause_asked_{false};   ///< while it moved or waited, with no message since
  bool paused_{false};        ///< a pause was asked for, and no resume
  std::uint64_t rendered_{0};
  double most_speed_{0.0};
};

}  // namespace osteon::property
