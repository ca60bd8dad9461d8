#pragma once

#include <limits>
#include <optional>

#include "control/compliance/compliance.h"
#include "control/coupling/virtual_coupling.h"
#include "control/guidance/guidance_field.h"
#include "control/laws/admittance_law.h"
#include "control/laws/impedance_law.h"
#include "control/sensing/bias_estimator.h"
#include "control/sensing/hand_wrench.h"
#include "control/setup/joint_path.h"
#include "control/stability/stabilisers.h"
#include "control/stability/vibration_index.h"
#include "kinematics/chain_params.h"
#include "kinematics/redundancy.h"
#include "safety/depth_limit.h"
#include "safety/energy_limits.h"
#include "safety/force_limit_reaction.h"
#include "safety/joint_guard.h"
#include "safety/limits.h"
#include "safety/spindle_trip.h"
#include "safety/watchdog.h"
#include "safety/workspace.h"

namespace osteon::control {

/// Position at which rendering begins. An arm that is handed over elsewhere first moves there.
struct StartParams {
  /// [rad]; a six-axis arm uses the first six.
  kinematics::JointVectorN<7> q{kinematics::JointVectorN<7>::Zero()};
  JointPathParams path;
  double tolerance_rad{2e-3};  ///< tolerance of each joint at the start; > 0
  /// If the hand pushes harder than this, the arm stops on its path until the hand lets go; > 0 [N].
  double pause_force_N{40.0};
};

/// How the coupling reaches the hand.
enum class Law : std::uint8_t {
  kAdmittance,  ///< arm in position mode: it follows a virtual tool that hand and coupling move
  kImpedance,   ///< arm in its own impedance control: the coupling is FRI's wrench or torque overlay
};

/// All parameters of the servo loop. All but the arm's limits (joints.limits) have usable defaults.
struct ServoParams {
  Law law{Law::kAdmittance};
  AdmittanceParams admittance;
  VibrationParams vibration;
  StabiliserParams stabilisers;
  ImpedanceParams impedance;
  CouplingParams coupling;
  safety::WrenchLimitParams wrench;
  safety::SensorForceParams sensor_force;
  safety::TwistLimitParams twist;
  safety::WorkspaceParams workspace;  ///< its deceleration should not exceed stop_deceleration
  safety::JointGuardParams joints;    ///< its limits are the arm's own and have no default
  safety::WatchdogParams watchdog;
  safety::DepthLimitParams depth;
  ComplianceParams compliance;  ///< compliant parts; all absent: the cell is rigid
  /// Guidance along a surgical plan with the tool in use; absent: none.
  std::optional<GuidanceParams> guidance;
  safety::EnergyLimitParams energy;
  safety::ForceLimitReactionParams on_force_limit;  ///< kSlow needs the admittance law
  safety::SpindleLimitParams spindle_limits;
  double max_elbow_speed_m_per_s{std::numeric_limits<double>::infinity()};  ///< limit for an LBR; > 0
  double spindle_rad_per_s{26.18};           ///< speed while rendering (250 rpm); 0: the spindle stays still
  double stop_deceleration_m_per_s2{3.0};    ///< deceleration of the tool in a stop
  double stop_deceleration_rad_per_s2{8.0};  ///< as above, for rotation
  double joint_stop_s{0.1};                  ///< duration of a stop along the joints
  /// Longest travel of the apex between a frame's pose and the next frame's arrival; it limits the tool's
  /// speed. A frame's planes reach only e = CuttingParams::normal_enlargement_m beyond the tool. The apex may
  /// therefore enter bone by up to this travel before a frame reports that bone. The resulting step of the
  /// force stays below the limit of safety::WrenchRateTrip if this value is at most e + 1.5 max_speed period
  /// / (1 + damping_share).
  double model_sight_m{0.5e-3};
  double arm_angle_rate_rad_per_s{0.1};  ///< fastest turn of the elbow to the wanted arm angle
  /// Largest acceleration of the commanded joints, as a factor on the accelerations of joints.limits; > 0.
  /// The default is above 1 because the published limits are for planned motions. A virtual wall of 20 kN/m
  /// that is met at 0.25 m/s needs 3.4 times the published acceleration. With a factor of 1 the tool would
  /// enter this wall 7.1 mm deep instead of 3.9 mm, which amounts to a hidden limit of the force.
  double joint_acceleration_share{4.0};
  kinematics::PosturePreferenceParams posture;
  /// Load at the tool's origin, along and across the tool's z, that the posture should be able to hold; needs
  /// arm_body. If zero, only joint limits and singular postures move the elbow.
  kinematics::ToolLoad posture_load;
  double max_tracking_error_m{0.03};  ///< largest distance between the measured and the commanded tool
  double period_s{0.001};             ///< period of the arm's messages
  ForceSensorParams sensor;
  BiasParams sensor_bias;
  /// Absent: rendering begins where the arm is handed over. A path for an LBR needs arm_body.
  std::optional<StartParams> start;
  bool has_spindle{false};    ///< the spindle has a drive, whose reported speed the loop uses
  bool has_interlock{false};  ///< the cell has a PLC: nothing moves without its permission
  /// Model of the LBR with sensor and tool as payload. With it, the coupling is also limited to what the
  /// joint torques can hold in the posture. Absent, or without masses: only the cell's limits apply.
  std::optional<kinematics::ChainParams<7>> arm_body;
};

/// @throws std::invalid_argument naming the parameter, the value and what is accepted.
void Validate(const ServoParams& params);

/// The properties of the law in `params` that the stabilisers depend on.
/// @throws std::invalid_argument if the age governor is to act on a law without damping.
[[nodiscard]] StabilisedLaw LawOf(const ServoParams& params);
/// As above, for an admittance law with other gains, for example after a change of gains during a run.
[[nodiscard]] StabilisedLaw LawOf(const AdmittanceParams& law, const ServoParams& params) OSTEON_RT;

/// The lowest limit of the tool's speed: the cell's, that of the kinetic energy, and kReducedSpeed_m_per_s.
/// @param reduced the arm is in T1, or does not report its operation mode
[[nodiscard]] double ToolSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT;
/// The lowest limit of the elbow's speed: max_elbow_speed_m_per_s, or kReducedSpeed_m_per_s if `reduced`.
[[nodiscard]] double ElbowSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT;
/// Limit of the coupling's force: the cell's force limit, or the force at which the stored energy reaches its
/// bound, whichever is lower. The stored energy is computed with the stiffness 1 / (1/K + c): the coupling's
/// stiffness K in series with the compliance c of the compliant parts.
[[nodiscard]] double ForceLimit_N(const ServoParams& params) OSTEON_RT;

/// joint_stop_s in ticks, at least one.
[[nodiscard]] int JointStopTicks(const ServoParams& params) OSTEON_RT;

}  // namespace osteon::control
