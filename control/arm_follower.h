#pragma once

#include <limits>
#include <memory>

#include "control/ports.h"
#include "control/rt/marker.h"
#include "control/servo_params.h"
#include "kinematics/differential_inverse.h"
#include "kinematics/lbr_arm.h"
#include "kinematics/ortho_parallel_arm.h"
#include "kinematics/spatial.h"
#include "safety/fault.h"
#include "safety/limits.h"

namespace osteon::control {

/// How the tool should move in a tick.
struct FollowWish {
  Twist V_WT;  ///< of the tool at To, in W
  /// How fast the elbow may go to where it should be, before it has been there: 0 … 1. 0 holds it.
  double elbow_share{0.0};
  double max_elbow_speed_m_per_s{std::numeric_limits<double>::infinity()};
  bool elbow_moves{false};  ///< false: the elbow is held on its circle whatever the tool does
};

/// How it does.
struct Followed {
  Twist V_WT;               ///< what is left of the wish: of the commanded tool
  bool limited{false};      ///< by joints, reach or a singular posture: less than wished
  bool elbow_acted{false};  ///< the elbow's speed was at its limit: less than wished
  bool zone_acted{false};   ///< flange or elbow came near a bound of theirs: less than wished
  safety::Fault fault{safety::Fault::kNone};  ///< nothing has moved: kInverseKinematics, kJointLimit
};

/// How flange and elbow keep to their zones on a way of the joints.
struct ZoneLook {
  double share{1.0};    ///< of the way at which they heed their bounds, 0 … 1
  bool outside{false};  ///< one of the two is outside at its end
};

/// A tick of the way to the start.
struct StartStep {
  /// The path asks for what may not be commanded, kJointLimit or kWorkspace; nothing has moved.
  safety::Fault refused{safety::Fault::kNone};
  bool there{false};
  bool rests{false};  ///< paused, at rest
};

/// The joints of the arm under the servo loop: where they are commanded, and how they follow the tool. The
/// commanded pose is that of the commanded joints at every tick: there is no drift between the two. Joint
/// arrays have seven slots; of a six-axis arm the last is 0.
class ArmFollower {
 public:
  virtual ~ArmFollower() = default;

  /// Tool pose of any joints, X_WT.
  [[nodiscard]] virtual Pose ToolPose(const JointArray& q) const OSTEON_RT = 0;
  /// Commanded joints [rad] and the tool's pose there.
  [[nodiscard]] virtual JointArray q() const OSTEON_RT = 0;
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return X_WT_; }

  /// The arm is there, at rest. @pre finite
  virtual void Put(const JointArray& q) OSTEON_RT = 0;
  /// The joints stand still.
  virtual void Rest() OSTEON_RT = 0;
  /// Before the first Follow, and after a pause of it.
  virtual void StartFollowing() OSTEON_RT = 0;

  /// One tick along a twist (kinematics::DifferentialInverse), by the redundant joint's preferences where
  /// there is one.
  [[nodiscard]] virtual Followed Follow(const FollowWish& wish) OSTEON_RT = 0;

  /// One tick toward where the arm is, of an arm that gives: by a share of the way, within the joints'
  /// limits.
  /// @returns kNone, or kJointLimit with nothing moved
  [[nodiscard]] virtual safety::Fault FollowMeasured(const JointArray& q_meas, double share) OSTEON_RT = 0;
  /// Joint torques of a wrench on T at To, in W: J^T F at these joints, and of it what they hold.
  [[nodiscard]] virtual JointArray Torques(const JointArray& q, const Wrench& F_T_W) const OSTEON_RT = 0;

  /// Whether what acts on the joints from outside, by the arm's estimate [N·m], will be beyond what they hold
  /// within a message (safety::JointTorqueLimit). Once a message; false where the arm's torques are not
  /// known.
  [[nodiscard]] virtual bool TakeTorques(const JointArray& tau_external_Nm) OSTEON_RT = 0;

  /// One tick of a stop in which the joints' own last motion is scaled down, within
  /// ServoParams::joint_stop_s: for where the tool's path has no joints. True at rest.
  [[nodiscard]] virtual bool BrakeJoints() OSTEON_RT = 0;
  /// Such a stop is under way.
  [[nodiscard]] virtual bool braking_joints() const OSTEON_RT = 0;

  /// Flange and elbow of an arm that gives, on its way between two ticks.
  [[nodiscard]] virtual ZoneLook LookAtZones(const JointArray& q,
                                             const JointArray& q_next) const OSTEON_RT = 0;

  /// See ServoLoop::Prefetch.
  virtual void Prefetch() const OSTEON_RT = 0;

  /// ServoParams::start is where the arm is, or there is none.
  [[nodiscard]] virtual bool AtStart() const OSTEON_RT = 0;
  /// False where the arm stands where no command may put it.
  [[nodiscard]] virtual bool BeginStart() OSTEON_RT = 0;
  [[nodiscard]] virtual StartStep StepToStart(bool permitted) OSTEON_RT = 0;

  /// The limiter's wrench, and no more than the arm's torques hold where it is told to be, as far as they are
  /// known: that is where it will be when the wrench arrives.
  [[nodiscard]] virtual safety::LimitedWrench Limit(const safety::WrenchLimiter& limiter,
                                                    const Wrench& F_T_W) const OSTEON_RT = 0;

 protected:
  Pose X_WT_{Pose::Identity()};
};

/// The cell's workspace; where the reamer's depth limit acts, with its bound as a zone of the apex.
[[nodiscard]] safety::WorkspaceParams WorkspaceOf(const ServoParams& params);

/// What the differential inverse is told. A radian weighs as the virtual tool's radius of gyration: what a
/// vanishing direction takes from the twist is then what a smooth stop would take from a body of that mass
/// and inertia. @tparam N number of joints, 6 or 7
template <int N>
[[nodiscard]] kinematics::DifferentialInverseParams<N> MotionParams(const ServoParams& params);

/// @param X_WB robot base in world  @param X_FT tool on the flange  @param arm_angle_rad wanted in the run
/// @throws std::invalid_argument naming the parameter, the value and what is accepted.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::LbrArm& arm, const Pose& X_WB,
                                                        const Pose& X_FT, double arm_angle_rad);
/// An arm without a redundant joint and with no known torques: of ServoParams, posture, posture_load and
/// arm_body do not count.
[[nodiscard]] std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params,
                                                        const kinematics::OrthoParallelArm& arm,
                                                        const Pose& X_WB, const Pose& X_FT);

}  // namespace osteon::control
