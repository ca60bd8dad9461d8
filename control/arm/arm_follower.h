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
  /// Scales the speed at which the arm angle turns toward the wanted one, 0 … 1; 0 holds the elbow. It has
  /// an effect until the wanted angle has been reached once; from then on the elbow moves only while the tool
  /// does.
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
  /// kInverseKinematics or kJointLimit if the joints could not follow; nothing has moved then.
  safety::Fault fault{safety::Fault::kNone};
};

/// Whether flange and elbow stay in their zones during a joint motion.
struct ZoneCheck {
  double share{1.0};    ///< largest fraction of the motion that stays in the zones, 0 … 1
  bool outside{false};  ///< at the end of the motion, flange or elbow is outside its zone
};

/// Result of one tick of the path to the start.
struct StartStep {
  /// kJointLimit or kWorkspace if the path asks for an inadmissible command; nothing has moved then.
  safety::Fault refused{safety::Fault::kNone};
  bool at_start{false};
  bool paused{false};  ///< the path is paused, and the arm has come to rest on it
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

  /// Sets the table of tools that SelectTool chooses from. Call before the run. The tool in use stays.
  /// @throws std::invalid_argument naming what is wrong with an entry.
  virtual void SetTools(std::span<const LoopTool> tools) = 0;
  /// Changes to the tool of this table entry: the joints stay, bit for bit, and X_WT() becomes the pose of
  /// the new tool.
  /// @pre index < the table's size
  virtual void SelectTool(std::size_t index) OSTEON_RT = 0;

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
  /// Used where the tool's braking path has no joint solution. Returns true once the joints are at rest.
  [[nodiscard]] virtual bool BrakeJoints() OSTEON_RT = 0;
  /// Whether a stop by BrakeJoints is under way.
  [[nodiscard]] virtual bool braking_joints() const OSTEON_RT = 0;

  /// Checks the zones of flange and elbow of a compliant arm between two ticks.
  [[nodiscard]] virtual ZoneCheck CheckZones(const JointArray& q,
                                             const JointArray& q_next) const OSTEON_RT = 0;

  /// Loads the follower's data into the processor's cache, see ServoLoop::Prefetch.
  virtual void Prefetch() const OSTEON_RT = 0;

  /// Whether the arm is at ServoParams::start; true as well if no start is set.
  [[nodiscard]] virtual bool AtStart() const OSTEON_RT = 0;
  /// Begins the path to the start. False if the present joint positions are outside the range that may be
  /// commanded.
  [[nodiscard]] virtual bool BeginStartPath() OSTEON_RT = 0;
  /// Advances the path to the start by one tick. If motion is not permitted, the path is paused.
  [[nodiscard]] virtual StartStep StepToStart(bool permitted) OSTEON_RT = 0;

  /// Limits a wrench by the limiter and, if the arm's masses and torques are known, to what it can hold.
  /// The posture is the commanded one, because the arm will be there when the wrench arrives.
  [[nodiscard]] virtual safety::LimitedWrench Limit(const safety::WrenchLimiter& limiter,
                                                    const Wrench& F_T_W) const OSTEON_RT = 0;

 protected:
  Pose X_WT_{Pose::Identity()};
};

/// The cell's workspace. If the reamer's depth limit is on, its bound is added as a zone of the apex.
[[nodiscard]] safety::WorkspaceParams WorkspaceOf(const ServoParams& params);

/// Parameters of the differential inverse kinematics. Rotations are weighted against translations by the
/// virtual tool's radius of gyration. When a singular posture blocks a direction, the twist then changes as
/// the velocity of a free body of that mass and inertia would if a smooth wall stopped it.
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
