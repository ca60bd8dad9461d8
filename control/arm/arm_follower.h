#pragma once

#include <limits>
#include <memory>

#include "base/marker.h"
#include "control/ports.h"
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
  Twist V_WT;  ///< of the tool at To, in W
  /// Scales the elbow's speed toward its preferred place until it has been there, 0 … 1; 0 holds the elbow.
  double elbow_share{0.0};
  double max_elbow_speed_m_per_s{std::numeric_limits<double>::infinity()};
  bool elbow_moves{false};  ///< false: the elbow is held on its circle, however the tool moves
};

/// Motion of the tool that results.
struct MotionResult {
  Twist V_WT;               ///< commanded tool: what is left of the request
  bool limited{false};      ///< joint limits, reach or a singular posture reduced the motion
  bool elbow_acted{false};  ///< the elbow's speed limit reduced the motion
  bool zone_acted{false};   ///< a zone of flange or elbow reduced the motion
  safety::Fault fault{safety::Fault::kNone};  ///< nothing has moved: kInverseKinematics, kJointLimit
};

/// How flange and elbow keep to their zones over a joint motion.
struct ZoneCheck {
  double share{1.0};    ///< largest fraction of the motion that keeps to the zones, 0 … 1
  bool outside{false};  ///< flange or elbow is outside at its end
};

/// Result of a tick of the motion to the start.
struct StartStep {
  /// kJointLimit or kWorkspace if the path asks for an inadmissible command; nothing has moved then.
  safety::Fault refused{safety::Fault::kNone};
  bool at_start{false};
  bool paused{false};  ///< paused, at rest
};

/// The arm's joints under the servo loop: their commanded positions, and how they follow the tool. The
/// commanded pose is always the pose of the commanded joints, so the two cannot drift apart. Joint arrays
/// have seven slots; a six-axis arm leaves the last at 0.
class ArmFollower {
 public:
  virtual ~ArmFollower() = default;

  /// Tool pose X_WT for any joint positions.
  [[nodiscard]] virtual Pose ToolPose(const JointArray& q) const OSTEON_RT = 0;
  /// Commanded joint positions [rad]; X_WT() is the tool's pose there.
  [[nodiscard]] virtual JointArray q() const OSTEON_RT = 0;
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return X_WT_; }

  /// Sets the commanded joints, at rest. @pre finite
  virtual void ResetTo(const JointArray& q) OSTEON_RT = 0;
  /// Sets the joint velocities to zero.
  virtual void StopJoints() OSTEON_RT = 0;
  /// To be called before the first Follow and after each pause of following.
  virtual void StartFollowing() OSTEON_RT = 0;

  /// Moves the joints one tick along a twist (kinematics::DifferentialInverse), using the redundant joint's
  /// preferences if there is one.
  [[nodiscard]] virtual MotionResult Follow(const MotionRequest& request) OSTEON_RT = 0;

  /// Moves the commanded joints of a compliant arm one tick toward the measured ones, by a share of the
  /// difference, within the joints' limits.
  /// @returns kNone, or kJointLimit with nothing moved
  [[nodiscard]] virtual safety::Fault FollowMeasured(const JointArray& q_meas, double share) OSTEON_RT = 0;
  /// Joint torques for a wrench on T at To, in W: J^T F at these joints, scaled to what they can hold.
  [[nodiscard]] virtual JointArray Torques(const JointArray& q, const Wrench& F_T_W) const OSTEON_RT = 0;

  /// Whether the external torques on the joints, by the arm's estimate [N·m], will exceed what the joints can
  /// hold within a message (safety::JointTorqueLimit). Call once per message; false if the arm's torques are
  /// unknown.
  [[nodiscard]] virtual bool PredictOverload(const JointArray& tau_external_Nm) OSTEON_RT = 0;

  /// One tick of a stop in which the joints' own last motion is scaled down within ServoParams::joint_stop_s.
  /// Used where the tool's braking path has no joint solution. True at rest.
  [[nodiscard]] virtual bool BrakeJoints() OSTEON_RT = 0;
  /// Whether a stop by BrakeJoints is under way.
  [[nodiscard]] virtual bool braking_joints() const OSTEON_RT = 0;

  /// Checks the zones of flange and elbow of a compliant arm between two ticks.
  [[nodiscard]] virtual ZoneCheck CheckZones(const JointArray& q,
                                             const JointArray& q_next) const OSTEON_RT = 0;

  /// Loads its data into the cache, see ServoLoop::Prefetch.
  virtual void Prefetch() const OSTEON_RT = 0;

  /// Whether the arm is at ServoParams::start; true as well if no start is set.
  [[nodiscard]] virtual bool AtStart() const OSTEON_RT = 0;
  /// Begins the path to the start. False if the arm stands where no command may put it.
  [[nodiscard]] virtual bool BeginStartPath() OSTEON_RT = 0;
  [[nodiscard]] virtual StartStep StepToStart(bool permitted) OSTEON_RT = 0;

  /// Limits a wrench by the limiter, and to what the arm's torques can hold at the commanded joints, where
  /// the arm will be when the wrench arrives; the latter only as far as the torques are known.
  [[nodiscard]] virtual safety::LimitedWrench Limit(const safety::WrenchLimiter& limiter,
                                                    const Wrench& F_T_W) const OSTEON_RT = 0;

 protected:
  Pose X_WT_{Pose::Identity()};
};

/// The cell's workspace; if the reamer's depth limit acts, with its bound as a zone of the apex.
[[nodiscard]] safety::WorkspaceParams WorkspaceOf(const ServoParams& params);

/// Parameters of the differential inverse. A radian weighs as the virtual tool's radius of gyration: a
/// vanishing direction then takes from the twist what a smooth stop would take from a body of that mass and
/// inertia. @tparam N number of joints, 6 or 7
template <int N>
[[nodiscard]] kinematics::DifferentialInverseParams<N> DifferentialInverseParamsOf(const ServoParams& params);

/// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad wanted in the run
/// @throws std::invalid_argument naming the parameter, the value and what is accepted.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::LbrArm& arm, const Pose& X_WB,
                                                        const Pose& X_FT, double arm_angle_rad);
/// An arm without a redundant joint and with unknown torques: ignores posture, posture_load and arm_body.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::OrthoParallelArm& arm,
                                                        const Pose& X_WB, const Pose& X_FT);

}  // namespace osteon::control
