#pragma once

#include <limits>
#include <optional>

#include "control/admittance_law.h"
#include "control/bias_estimator.h"
#include "control/hand_wrench.h"
#include "control/impedance_law.h"
#include "control/joint_path.h"
#include "control/stabilisers.h"
#include "control/vibration_index.h"
#include "control/virtual_coupling.h"
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

/// Where rendering begins. An arm that is handed over elsewhere moves there first.
struct StartParams {
  kinematics::JointVectorN<7> q{
      kinematics::JointVectorN<7>::Zero()};  ///< [rad]; of a six-axis arm the first six
  JointPathParams path;
  double there_rad{2e-3};  ///< tolerance of each joint at the start; > 0
  /// If the hand pushes harder than this, the arm rests on its path until it lets go; > 0 [N].
  double pause_force_N{40.0};
};

/// How the coupling reaches the hand.
enum class Law : std::uint8_t {
  kAdmittance,  ///< the arm in position mode: a virtual tool, moved by hand and coupling, is where the arm
                ///< goes
  kImpedance,   ///< the arm carries itself (FRI's wrench or torque overlay): the coupling is added to it
};

/// All parameters of the servo loop. Every field has a usable default except the arm's limits
/// (joints.limits).
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
  safety::WorkspaceParams workspace;  ///< deceleration: should not exceed the stop's
  safety::JointGuardParams joints;    ///< limits: the arm's own, no default
  safety::WatchdogParams watchdog;
  safety::DepthLimitParams depth;
  safety::EnergyLimitParams energy;
  safety::ForceLimitReactionParams on_force_limit;  ///< kSlow needs the admittance law
  safety::SpindleLimitParams spindle_limits;
  double max_elbow_speed_m_per_s{std::numeric_limits<double>::infinity()};  ///< of an LBR; > 0
  double spindle_rad_per_s{26.18};           ///< while rendering; 250 rpm; 0 for a still spindle
  double stop_deceleration_m_per_s2{3.0};    ///< of the tool in a Stop 1
  double stop_deceleration_rad_per_s2{8.0};  ///< the same, turning
  double joint_stop_s{0.1};                  ///< time to rest of a stop along the joints
  /// How far the apex may travel between a frame's pose and the next frame's arrival: bone that its planes do
  /// not reach yet may be met that deep. They reach e = CuttingParams::normal_enlargement_m beyond the tool,
  /// so the step stays below the trip on the wrench's rate up to e + 1.5 max_speed period / (1 +
  /// damping_share).
  double model_sight_m{0.5e-3};
  double arm_angle_rate_rad_per_s{0.1};  ///< most, to the wanted arm angle
  /// Of the joints' accelerations (joints.limits): how fast the commanded motion may change; > 0. The
  /// published figures are for planning. A virtual wall of 20 kN/m that is met at .25 m/s asks for 3.4 times
  /// as much; held to 1 it is met 7.1 mm deep instead of 3.9, a limit on force in disguise.
  double joint_acceleration_share{4.0};
  kinematics::PosturePreferenceParams posture;
  /// What the posture should hold, along the tool's z and across it at its origin; needs arm_body. With
  /// nothing in it the elbow is led by limits and singular postures alone.
  kinematics::ToolLoad posture_load;
  double max_tracking_error_m{0.03};  ///< measured from commanded tool position
  double period_s{0.001};             ///< of the arm's messages
  ForceSensorParams sensor;
  BiasParams sensor_bias;
  std::optional<StartParams> start;  ///< absent: where the arm is handed over; of an LBR needs arm_body
  bool has_spindle{false};           ///< the spindle has a drive: what it says of its speed counts
  bool has_interlock{false};         ///< the cell has a PLC: nothing moves without its permission
  /// The LBR with sensor and tool as its payload: the coupling is scaled to what its torques can hold in the
  /// posture. Absent, or without masses: the cell's limits alone.
  std::optional<kinematics::ChainParams<7>> arm_body;
};

/// @throws std::invalid_argument naming the parameter, the value and what is accepted.
void Validate(const ServoParams& params);

/// What the stabilisers have to know of the law.
/// @throws std::invalid_argument where the age governor is to act on a law without damping.
[[nodiscard]] StabilisedLaw LawOf(const ServoParams& params);
/// The same of an admittance law, whose gains may change in a tick.
[[nodiscard]] StabilisedLaw LawOf(const AdmittanceParams& law, const ServoParams& params) OSTEON_RT;

/// The tightest bound of the tool's speed: the cell's, by its kinetic energy, and kReducedSpeed_m_per_s.
/// @param reduced the arm is in T1, or does not say how it is operated
[[nodiscard]] double ToolSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT;
/// The same of the elbow.
[[nodiscard]] double ElbowSpeedLimit_m_per_s(const ServoParams& params, bool reduced) OSTEON_RT;
/// The coupling's force at its stiffness: the cell's, or by the energy that its spring stores.
[[nodiscard]] double ForceLimit_N(const ServoParams& params) OSTEON_RT;

/// joint_stop_s in ticks, at least one.
[[nodiscard]] int JointStopTicks(const ServoParams& params) OSTEON_RT;

}  // namespace osteon::control
