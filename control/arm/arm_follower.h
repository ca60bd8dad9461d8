#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>

#include "base/marker.h"
#include "control/ports.h"
#include "control/setup/loop_tool.h"
#include "control/setup/servo_params.h"
#include "kinematics/differential_inverse.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/spatial.h"
#include "safety/fault.h"
#include "safety/limits.h"

namespace osteon::control {

/// Motion of the tool that is requested in a tick.
struct MotionRequest {
  Twist V_WT;  ///< requested velocity of the tool at To, in W
  /// Factor 0 … 1 on the speed at which the arm angle turns toward the wanted one; 0 holds the elbow. It has
  /// an effect until the wanted angle has been reached once. After that the elbow moves only while the tool
  /// moves.
  double elbow_scale{0.0};
  double max_elbow_speed_m_per_s{std::numeric_limits<double>::infinity()};
  bool elbow_moves{false};  ///< false: the arm angle is held while the tool moves
};

/// The tool's motion after all limits.
struct MotionResult {
  Twist V_WT;               ///< commanded velocity: the request after all limits
  bool limited{false};      ///< joint limits, reach or a singular posture reduced the motion
  bool elbow_acted{false};  ///< the elbow's speed limit reduced the motion
  bool zone_acted{false};   ///< a zone of flange or elbow reduced the motion
  /// kInverseKinematics or kJointLimit if the joints could not follow. In this case nothing has moved.
  safety::Fault fault{safety::Fault::kNone};
};

/// Whether flange and elbow stay in their zones during a joint motion.
struct ZoneCheck {
  double share{1.0};    ///< largest fraction of the motion that stays in the zones, 0 … 1
  bool outside{false};  ///< at the end of the motion, flange or elbow is outside its zone
};

/// Result of one tick of the path to the start.
struct StartStep {
  /// kJointLimit or kWorkspace if the path led to an inadmissible command. In this case nothing has moved.
  safety::Fault refused{safety::Fault::kNone};
  bool at_start{false};
  bool paused{false};  ///< the path is paused, and the arm has come to rest on it
};

/// The arm's joints under the servo loop: their commanded positions, and how they follow the tool. The
/// commanded pose is always computed from the commanded joints, so that pose and joints cannot drift apart.
/// Joint arrays have seven slots; a six-axis arm leaves the last at 0.
class ArmFollower {
 public:
  virtual ~ArmFollower() = default;

  /// Tool pose X_WT for any joint positions.
  [[nodiscard]] virtual Pose ToolPose(const JointArray& q) const OSTEON_RT = 0;
  /// Commanded joint positions [rad]; X_WT() is the tool's pose there.
  [[nodiscard]] virtual JointArray q() const OSTEON_RT = 0;
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return X_WT_; }

  /// Sets the table of tools for SelectTool. Call before the run. The tool in use does not change.
  /// @throws std::invalid_argument naming what is wrong with an entry.
  virtual void SetTools(std::span<const LoopTool> tools) = 0;
  /// Selects a tool of the table. The commanded joints stay unchanged; X_WT() becomes the pose of the new
  /// tool.
  /// @pre index < the table's size
  virtual void SelectTool(std::size_t index) OSTEON_RT = 0;

  /// Sets the commanded joints, at rest. @pre finite
  virtual void ResetTo(const JointArray& q) OSTEON_RT = 0;
  /// Sets the joint velocities to zero.
  virtual void StopJoints() OSTEON_RT = 0;
  /// Call before the first Follow, and before Follow is called again after a pause.
  virtual void StartFollowing() OSTEON_RT = 0;

  /// Moves the joints for one tick along a twist (kinematics::DifferentialInverse). The redundant joint of an
  /// LBR follows its posture preferences.
  [[nodiscard]] virtual MotionResult Follow(const MotionRequest& request) OSTEON_RT = 0;

  /// For an arm in impedance control: moves the commanded joints for one tick toward the measured ones, by a
  /// share of their difference and within the joints' limits.
  /// @returns kNone, or kJointLimit with nothing moved
  [[nodiscard]] virtual safety::Fault FollowMeasured(const JointArray& q_meas, double share) OSTEON_RT = 0;
  /// Joint torques for a wrench on T at To, in W: J^T F at these joint positions, scaled down to what the
  /// joints can hold.
  [[nodiscard]] virtual JointArray Torques(const JointArray& q, const Wrench& F_T_W) const OSTEON_RT = 0;

  /// Whether the external torques on the joints, as the arm estimates them [N·m], will exceed what the joints
  /// can hold before the next message arrives (safety::JointTorqueLimit). Call once per message. False if the
  /// arm's torque limits are unknown.
  [[nodiscard]] virtual bool PredictOverload(const JointArray& tau_external_Nm) OSTEON_RT = 0;

  /// One tick of a stop along the joints' last motion, which is scaled to zero within
  /// ServoParams::joint_stop_s. Used if the joints cannot follow the tool's braking path. Returns true once
  /// the joints are at rest.
  [[nodiscard]] virtual bool BrakeJoints() OSTEON_RT = 0;
  /// Whether a stop by BrakeJoints is under way.
  [[nodiscard]] virtual bool braking_joints() const OSTEON_RT = 0;

  /// Checks the zones of flange and elbow for a motion of an arm in impedance control between two ticks.
  [[nodiscard]] virtual ZoneCheck CheckZones(const JointArray& q,
                                             const JointArray& q_next) const OSTEON_RT = 0;

  /// Loads the follower's data into the processor's cache (ServoLoop::Prefetch).
  virtual void Prefetch() const OSTEON_RT = 0;

  /// Whether the arm is at ServoParams::start; true as well if no start is set.
  [[nodiscard]] virtual bool AtStart() const OSTEON_RT = 0;
  /// Begins the path to the start. False if the present joint positions are outside the range that may be
  /// commanded.
  [[nodiscard]] virtual bool BeginStartPath() OSTEON_RT = 0;
  /// Advances the path to the start by one tick. If motion is not permitted, the path is paused.
  [[nodiscard]] virtual StartStep StepToStart(bool permitted) OSTEON_RT = 0;

  /// Limits a wrench by the limiter and, if the arm's masses and torques are known, to what the arm can hold.
  /// The check uses the commanded posture, which the arm will have reached when the wrench takes effect.
  [[nodiscard]] virtual safety::LimitedWrench Limit(const safety::WrenchLimiter& limiter,
                                                    const Wrench& F_T_W) const OSTEON_RT = 0;

 protected:
  Pose X_WT_{Pose::Identity()};
};

/// The cell's workspace. If the reamer's depth limit is on, its bound is added as a zone of the apex.
[[nodiscard]] safety::WorkspaceParams WorkspaceOf(const ServoParams& params);

/// Parameters of the differential inverse kinematics. Rotations are weighted against translations by the
/// virtual tool's radius of gyration. With this weight, a singular posture that blocks a direction changes
/// the twist as a smooth wall changes the velocity of a free body with the virtual tool's mass and inertia.
/// @tparam N number of joints, 6 or 7
template <int N>
[[nodiscard]] kinematics::DifferentialInverseParams<N> DifferentialInverseParamsOf(const ServoParams& params);

/// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad arm angle to be kept
/// in the run
/// @throws std::invalid_argument naming the parameter, the value and what is accepted.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::LbrArm& arm, const Pose& X_WB,
                                                        const Pose& X_FT, double arm_angle_rad);
/// A follower for a six-axis arm. Such an arm has no redundant joint, and its torques are unknown: posture,
/// posture_load and arm_body are ignored.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::OrthoParallelArm& arm,
                                                        const Pose& X_WB, const Pose& X_FT);

}  // namespace osteon::control
