#include "control/arm/arm_follower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "base/prefetch.h"
#include "control/laws/twist_parts.h"
#include "kinematics/force_capability.h"
#include "kinematics/redundancy.h"
#include "kinematics/serial_chain.h"
#include "safety/joint_guard.h"
#include "safety/joint_torque_limit.h"
#include "safety/workspace.h"

namespace osteon::control {
namespace {

using safety::Fault;

constexpr double kElbowRate_per_s = 40.0;  // speed of the arm angle per rad of error
constexpr double kElbowThere_rad = 1e-6;   // error below which the wanted arm angle is reached
constexpr double kMoving_m_per_s = 0.02,
                 kMoving_rad_per_s = 0.1;  // tool speeds from which the elbow may move at full speed
constexpr double kStands = 1e-6;           // a smaller share of these tool speeds is a rounding error
constexpr int kBrakingHalvings = 10;       // number of bisections in BrakeBeforeBounds
constexpr int kZoneTries = 4;              // number of trial shares of a step in ZoneScale
constexpr double kZoneSlack = 0.999;  // factor on a trial share, so that the next trial stays in the zones

double WrapAngle(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

// Data that only an LBR has: an elbow that can move while the tool stands still, and known joint torques.
struct Redundancy {
  Redundancy(const ServoParams& params, const Pose& X_WB, const Pose& X_FT, double wanted_arm_angle_rad)
      : arm_angle_rad(wanted_arm_angle_rad) {
    if (!std::isfinite(arm_angle_rad)) throw std::invalid_argument("arm_angle_rad: accepted a finite angle");
    if (!params.arm_body || !params.arm_body->has_masses) return;
    load.load = params.posture_load;
    load.p_F = X_FT.translation();
    load.axis_F = X_FT.linear().col(2);
    kinematics::JointVectorN<7>& torque_limit_Nm = load.torque_limit_Nm;
    for (int i = 0; i < 7; ++i) {
      torque_limit_Nm[i] = params.arm_body->joints[static_cast<std::size_t>(i)].limits.torque_Nm;
    }
    torques.emplace(torque_limit_Nm);
    body.emplace(*params.arm_body, X_WB.linear().transpose() * kinematics::kGravity_W_m_per_s2);
  }

  double arm_angle_rad;  // wanted arm angle
  std::optional<kinematics::SerialChain<7>> body;
  std::optional<safety::JointTorqueLimit<7>> torques;  // present if `body` is
  kinematics::LoadTarget<7> load;  // load that the arm shall be able to hold, with the drives' torque limits
  bool arrived{false};             // the wanted arm angle has been reached once
};
struct NoRedundancy {};

/// @tparam Arm  LbrArm or OrthoParallelArm
template <class Arm>
class JointFollower final : public ArmFollower {
 public:
  static constexpr int kN = Arm::kJoints;
  static constexpr bool kRedundant = kN == 7;
  using Joints = typename Arm::Joints;
  using Elbow = std::conditional_t<kRedundant, Redundancy, NoRedundancy>;

  JointFollower(const ServoParams& params, const Arm& arm, const kinematics::ChainParams<kN>* path_chain,
                const Pose& X_WB, const Pose& X_FT, Elbow elbow)
      : params_(params),
        arm_(arm),
        X_WB_(X_WB),
        X_BW_(X_WB.inverse()),
        X_FT_(X_FT),
        X_TF_(X_FT.inverse()),
        elbow_(std::move(elbow)),
        motion_(DifferentialInverseParamsOf<kN>(params)),
        guard_(params.joints),
        workspace_(WorkspaceOf(params)) {
    if (!params.start) return;
    if (!path_chain)
      throw std::invalid_argument(
          "servo start: found no arm_body, accepted one: its path needs the arm's lengths");
    path_.emplace(params.start->path, *path_chain, X_FT.translation());
  }

  [[nodiscard]] Pose ToolPose(const JointArray& q) const OSTEON_RT override { return PoseOf(ToJoints(q)); }
  [[nodiscard]] JointArray q() const OSTEON_RT override {
    JointArray q{};
    std::copy_n(q_.data(), kN, q.begin());
    return q;
  }

  void SetTools(std::span<const LoopTool> tools) override {
    tools_.clear();
    for (const LoopTool& tool : tools) {
      Tool& made = tools_.emplace_back(Tool{.X_FT = tool.X_FT, .body = {}});
      if constexpr (kRedundant)
        if (tool.arm_body && elbow_.body)
          made.body.emplace(*tool.arm_body, X_WB_.linear().transpose() * kinematics::kGravity_W_m_per_s2);
    }
  }
  void SelectTool(std::size_t index) OSTEON_RT override {
    const Tool& tool = tools_[index];
    X_FT_ = tool.X_FT;
    X_TF_ = X_FT_.inverse();
    if constexpr (kRedundant) {
      elbow_.load.p_F = X_FT_.translation();
      elbow_.load.axis_F = X_FT_.linear().col(2);
      if (tool.body) elbow_.body = tool.body;
    }
    jacobian_q_ = points_q_ = gravity_q_ = kNowhere;  // the cached values belong to the previous tool
    X_WT_ = PoseOf(q_);
  }

  void ResetTo(const JointArray& q) OSTEON_RT override {
    q_ = ToJoints(q);
    X_WT_ = PoseOf(q_);
    StopJoints();
  }
  void StopJoints() OSTEON_RT override { q_step_.setZero(); }
  void StartFollowing() OSTEON_RT override {
    motion_scale_ = 1.0;
    moving_ = 0.0;
    if constexpr (kRedundant) elbow_.arrived = false;
  }

  [[nodiscard]] MotionResult Follow(const MotionRequest& request) OSTEON_RT override;
  [[nodiscard]] Fault FollowMeasured(const JointArray& q_meas, double share) OSTEON_RT override {
    const auto guard = guard_.Limit(q_, share * (ToJoints(q_meas) - q_), params_.period_s);
    if (guard.jump || guard.violated) return Fault::kJointLimit;
    q_step_ = guard.step;
    q_ += q_step_;
    X_WT_ = PoseOf(q_);
    return Fault::kNone;
  }
  [[nodiscard]] JointArray Torques(const JointArray& q, const Wrench& F_T_W) const OSTEON_RT override {
    Eigen::Matrix<double, 6, 1> F_B;
    F_B << X_BW_.linear() * F_T_W.f, X_BW_.linear() * F_T_W.t;
    Joints tau = arm_.JacobianAt(ToJoints(q), X_FT_.translation()).transpose() * F_B;
    if constexpr (kRedundant)
      if (elbow_.torques) tau *= elbow_.torques->MaxScale(elbow_.body->Gravity(ToJoints(q)), tau);
    JointArray result{};
    std::copy_n(tau.data(), kN, result.begin());
    return result;
  }
  [[nodiscard]] bool PredictOverload([[maybe_unused]] const JointArray& tau_external_Nm) OSTEON_RT override {
    if constexpr (kRedundant)
      return elbow_.torques && elbow_.torques->PredictOverload(Gravity(), ToJoints(tau_external_Nm));
    return false;
  }
  [[nodiscard]] bool BrakeJoints() OSTEON_RT override;
  [[nodiscard]] bool braking_joints() const OSTEON_RT override { return stop_ticks_ > 0; }

  [[nodiscard]] ZoneCheck CheckZones(const JointArray& q, const JointArray& q_next) const OSTEON_RT override {
    if (!HasZones()) return {};
    const Joints from = ToJoints(q), to = ToJoints(q_next);
    const Points points = PointsOf(to);
    return {.share = ZoneScale(from, to - from, PointsOf(from), points, kCarried),
            .outside = std::any_of(kCarried.begin(), kCarried.end(), [&](ZonePoint point) {
              return workspace_.Has(point) && workspace_.Violated(At(points, point), point);
            })};
  }

  void Prefetch() const OSTEON_RT override { rt::Prefetch(*this); }

  [[nodiscard]] bool AtStart() const OSTEON_RT override {
    return !path_ || (q_ - Start()).cwiseAbs().maxCoeff() <= params_.start->tolerance_rad;
  }
  [[nodiscard]] bool BeginStartPath() OSTEON_RT override { return path_->StartPath(q_, Start()); }
  [[nodiscard]] StartStep StepToStart(bool permitted) OSTEON_RT override;

  [[nodiscard]] safety::LimitedWrench Limit(const safety::WrenchLimiter& limiter,
                                            const Wrench& F_T_W) const OSTEON_RT override;

 private:
  using ZonePoint = safety::ZonePoint;
  // also limited by joints
  static constexpr std::array<ZonePoint, 2> kCarried{ZonePoint::kFlange, ZonePoint::kElbow};
  static constexpr std::array<ZonePoint, 3> kAll{ZonePoint::kApex, ZonePoint::kFlange, ZonePoint::kElbow};

  static Joints ToJoints(const JointArray& q) { return Eigen::Map<const Joints>(q.data()); }
  [[nodiscard]] Pose PoseOf(const Joints& q) const OSTEON_RT { return X_WB_ * arm_.FlangePose(q) * X_FT_; }
  // Jacobian of the apex at q_. Cached, because several functions use it in a tick.
  [[nodiscard]] const kinematics::JacobianN<kN>& Jacobian() const OSTEON_RT {
    if (jacobian_q_ != q_) {
      jacobian_ = arm_.JacobianAt(q_, X_FT_.translation());
      jacobian_q_ = q_;
    }
    return jacobian_;
  }
  // Torques that balance the arm's weight at q_, cached like the Jacobian. @pre the arm's masses are known
  [[nodiscard]] const Joints& Gravity() const OSTEON_RT {
    if constexpr (kRedundant) {
      if (gravity_q_ != q_) {
        gravity_Nm_ = elbow_.body->Gravity(q_);
        gravity_q_ = q_;
      }
    }
    return gravity_Nm_;
  }
  [[nodiscard]] Joints Start() const OSTEON_RT { return params_.start->q.template head<kN>(); }
  void BrakeBeforeBounds(const kinematics::MotionInput<kN>& wanted,
                         kinematics::MotionOutput<kN>& moves) const OSTEON_RT;
  [[nodiscard]] Joints NullSpaceVelocity(const MotionRequest& request) OSTEON_RT;

  // A prepared tool.
  struct Tool {
    Pose X_FT{Pose::Identity()};
    std::optional<kinematics::SerialChain<7>> body;  // absent: the body stays the same
  };

  // Positions in W of the points that have zones, by ZonePoint, and the flange pose for the same joints.
  struct Points {
    std::array<Vector3, 3> p_W{};
    Pose X_BF{Pose::Identity()};
  };
  static const Vector3& At(const Points& points, ZonePoint point) OSTEON_RT {
    return points.p_W[static_cast<std::size_t>(point)];
  }
  [[nodiscard]] Points PointsOf(const Joints& q) const OSTEON_RT;
  [[nodiscard]] double ElbowScale(const Points& from, const Points& to,
                                  double max_speed_m_per_s) const OSTEON_RT;
  [[nodiscard]] double ZoneScale(const Joints& q, const Joints& step, const Points& from, const Points& to,
                                 std::span<const ZonePoint> points) const OSTEON_RT;
  [[nodiscard]] bool HasZones() const OSTEON_RT {
    return workspace_.Has(ZonePoint::kFlange) || workspace_.Has(ZonePoint::kElbow);
  }

  ServoParams params_;
  Arm arm_;
  Pose X_WB_, X_BW_, X_FT_, X_TF_;
  [[no_unique_address]] Elbow elbow_;
  kinematics::DifferentialInverse<kN> motion_;
  safety::JointGuard<kN> guard_;
  safety::Workspace workspace_;
  std::optional<JointPath<kN>> path_;  // path to the start
  std::vector<Tool> tools_;

  Joints q_{Joints::Zero()};
  static inline const Joints kNowhere = Joints::Constant(std::numeric_limits<double>::quiet_NaN());
  // the members below are results of the last tick
  Joints q_step_{Joints::Zero()};
  double motion_scale_{1.0};  // share of the requested motion that the limits allowed
  Points points_{};           // points at the joint positions points_q_
  Joints points_q_{kNowhere};
  mutable kinematics::JacobianN<kN> jacobian_{kinematics::JacobianN<kN>::Zero()};
  mutable Joints jacobian_q_{kNowhere};
  mutable Joints gravity_Nm_{Joints::Zero()}, gravity_q_{kNowhere};
  double moving_{0.0};  // 0 … 1: tool speed relative to kMoving_*
  double sigma_min_m_{1.0};
  Joints sigma_gradient_m_{Joints::Zero()}, null_direction_{Joints::Zero()};
  Eigen::Matrix<double, 6, 6> directions_{Eigen::Matrix<double, 6, 6>::Identity()};  // MotionOutput::U
  int stop_ticks_{0};  // remaining ticks of a stop along the joints; 0: none is under way
};

template <class Arm>
MotionResult JointFollower<Arm>::Follow(const MotionRequest& request) OSTEON_RT {
  const double dt_s = params_.period_s;
  MotionResult result{.V_WT = request.V_WT};
  kinematics::MotionInput<kN> wanted;
  wanted.J = Jacobian();
  wanted.V_BT = ExpressedIn(X_BW_.linear(), request.V_WT);
  wanted.q = q_;
  wanted.qd_before = q_step_ / dt_s;
  wanted.share_before = motion_scale_;
  wanted.qd_null = NullSpaceVelocity(request);
  wanted.dt_s = dt_s;
  wanted.U_before = directions_;
  kinematics::MotionOutput<kN> moves = motion_.Step(wanted);
  if (!moves.finite) {
    result.fault = Fault::kInverseKinematics;
    return result;
  }
  if (moves.limit != kinematics::MotionLimit::kNone) BrakeBeforeBounds(wanted, moves);
  // check the limited motion independently of the inverse kinematics
  const auto guard = guard_.Limit(q_, dt_s * moves.qd, dt_s);
  if (guard.jump || guard.violated) {
    result.fault = Fault::kJointLimit;
    return result;
  }
  motion_scale_ = moves.share;
  directions_ = moves.U;
  moving_ = std::min(1.0, moves.V_BT.v.norm() / kMoving_m_per_s + moves.V_BT.w.norm() / kMoving_rad_per_s);
  if (moving_ < kStands) moving_ = 0.0;
  sigma_min_m_ = moves.sigma_min_m;
  sigma_gradient_m_ = moves.sigma_gradient_m;
  null_direction_ = moves.null_direction;
  double elbow_scale = 1.0, zone_scale = 1.0;
  if (HasZones() || std::isfinite(request.max_elbow_speed_m_per_s)) {
    if (q_ != points_q_) {
      points_ = PointsOf(q_);
      points_q_ = q_;
    }
    Points to = PointsOf(q_ + guard.step);
    elbow_scale = ElbowScale(points_, to, request.max_elbow_speed_m_per_s);
    if (elbow_scale < 1.0) to = PointsOf(q_ + elbow_scale * guard.step);
    zone_scale = ZoneScale(q_, elbow_scale * guard.step, points_, to, kCarried);
    if (elbow_scale == 1.0 && zone_scale == 1.0) {  // the next tick begins at `to`
      points_ = to;
      points_q_ = q_ + guard.step;
    }
  }
  const double share = elbow_scale * zone_scale;
  q_step_ = share * guard.step;
  q_ += q_step_;
  X_WT_ = points_q_ == q_ ? Pose(X_WB_ * points_.X_BF * X_FT_) : PoseOf(q_);
  result.limited = moves.limit != kinematics::MotionLimit::kNone || guard.share < 1.0;
  result.zone_acted = zone_scale < 1.0;
  result.elbow_acted = elbow_scale < 1.0;
  if (result.limited || share < 1.0)
    result.V_WT = ExpressedIn(X_WB_.linear(), Scaled(moves.V_BT, guard.share * share));
  return result;
}

// Makes the apex brake before a bound despite the joints' acceleration limits. The requested twist brakes,
// but these limits reduce every change of velocity, also its braking part: a hand that pushes hard along a
// bound would move the arm beyond it. Therefore the previous motion is first braked as the bounds require.
// Then as much of the requested motion is added as they allow. If the braking keeps the acceleration limits,
// so does the sum.
template <class Arm>
void JointFollower<Arm>::BrakeBeforeBounds(const kinematics::MotionInput<kN>& wanted,
                                           kinematics::MotionOutput<kN>& moves) const OSTEON_RT {
  const auto allows = [&](const Vector3& v_BT) {
    return workspace_.Allows(X_WT_.translation(), X_WB_.linear() * v_BT, params_.period_s);
  };
  if (allows(moves.V_BT.v)) return;
  const Eigen::Matrix<double, 6, 1> V_before = wanted.J * wanted.qd_before;
  const Vector3 v_before_WT = X_WB_.linear() * V_before.template head<3>();
  kinematics::MotionInput<kN> braking = wanted;
  braking.V_BT.v = X_BW_.linear() * workspace_.Limit(X_WT_.translation(), v_before_WT, params_.period_s).v_WT;
  braking.V_BT.w = V_before.template tail<3>();
  braking.qd_null = wanted.qd_before;
  braking.ignore_acceleration = true;
  kinematics::MotionOutput<kN> braked = motion_.Step(braking);
  // Moves `motion` toward `allowed` until the bounds allow it: bisection over the share of their difference.
  const auto pull_back = [&](const kinematics::MotionOutput<kN>& allowed,
                             kinematics::MotionOutput<kN>& motion) {
    double share = 0.0, upper = 1.0;
    for (int i = 0; i < kBrakingHalvings; ++i) {
      const double middle = 0.5 * (share + upper);
      (allows(allowed.V_BT.v + middle * (motion.V_BT.v - allowed.V_BT.v)) ? share : upper) = middle;
    }
    motion.qd = allowed.qd + share * (motion.qd - allowed.qd);
    motion.V_BT = {.v = allowed.V_BT.v + share * (motion.V_BT.v - allowed.V_BT.v),
                   .w = allowed.V_BT.w + share * (motion.V_BT.w - allowed.V_BT.w)};
  };
  if (!allows(braked.V_BT.v))
    pull_back({}, braked);  // near a singular posture the braked motion may be too fast: scale it down
  pull_back(braked, moves);
}

template <class Arm>
typename JointFollower<Arm>::Points JointFollower<Arm>::PointsOf(const Joints& q) const OSTEON_RT {
  const auto arm = arm_.Points(q);
  return {
      .p_W = {X_WB_ * (arm.X_BF * X_FT_.translation()), X_WB_ * arm.X_BF.translation(), X_WB_ * arm.p_BElbow},
      .X_BF = arm.X_BF};
}

// Share of a joint step that keeps the elbow's speed limit.
template <class Arm>
double JointFollower<Arm>::ElbowScale(const Points& from, const Points& to,
                                      double max_speed_m_per_s) const OSTEON_RT {
  const double distance_m = (At(to, ZonePoint::kElbow) - At(from, ZonePoint::kElbow)).norm();
  const double max_m = max_speed_m_per_s * params_.period_s;
  return distance_m > max_m ? max_m / distance_m : 1.0;
}

// Share of a joint step with which the points stay in their zones. The points' paths are curved, so each
// trial share is checked at the positions that it leads to. A step of zero is always allowed.
template <class Arm>
double JointFollower<Arm>::ZoneScale(const Joints& q, const Joints& step, const Points& from,
                                     const Points& to, std::span<const ZonePoint> points) const OSTEON_RT {
  double share = 1.0;
  Points reached = to;
  for (int tries = 0; tries < kZoneTries; ++tries) {
    double factor = 1.0;
    for (const ZonePoint point : points)
      if (workspace_.Has(point))
        factor =
            std::min(factor, workspace_.Share(point, At(from, point), At(reached, point), params_.period_s));
    if (factor >= 1.0) return share;
    share *= kZoneSlack * factor;
    reached = PointsOf(q + share * step);
  }
  return 0.0;
}

// Preferred joint velocities, by which the elbow is guided. Only their null-space part has an effect.
template <class Arm>
typename Arm::Joints JointFollower<Arm>::NullSpaceVelocity(
    [[maybe_unused]] const MotionRequest& request) OSTEON_RT {
  Joints qd = Joints::Zero();
  if constexpr (kRedundant) {
    const double dt_s = params_.period_s;
    // The part of the requested twist that the limits will probably allow, estimated from the previous tick.
    // With the whole twist, the elbow would compensate a tool motion that does not take place.
    const Twist V_likely_WT = Scaled(request.V_WT, motion_scale_);

    // The tool's motion keeps the arm angle; in addition, the arm angle turns toward the wanted one.
    const double arm_angle_rad = arm_.ArmAngle(q_);
    const double error_rad = WrapAngle(elbow_.arm_angle_rad - arm_angle_rad);
    elbow_.arrived |= std::abs(error_rad) < kElbowThere_rad;
    const double max_rate = params_.arm_angle_rate_rad_per_s;
    const double turn_share = !request.elbow_moves ? 0.0 : elbow_.arrived ? moving_ : request.elbow_scale;
    kinematics::LoadPreference<7> load;
    if (elbow_.body && (turn_share > 0.0 || moving_ > 0.0)) {
      const double held_load =
          kinematics::HeldLoad<7>(elbow_.load, Jacobian(), Gravity(), X_BW_.linear() * X_WT_.linear().col(2))
              .value;
      load = kinematics::LoadGradientMotion<7>(params_.posture, *elbow_.body, elbow_.load,
                                               {.q = q_, .n = null_direction_, .held = held_load});
    }
    // the turn toward the wanted arm angle fades out where the arm could not hold the load
    const double load_factor = 1.0 - load.depth * load.depth;
    const double turn_rad_per_s =
        load_factor * turn_share * std::clamp(kElbowRate_per_s * error_rad, -max_rate, max_rate);
    Joints q_next;
    if (turn_rad_per_s == 0.0 && V_likely_WT.v.isZero(0.0) && V_likely_WT.w.isZero(0.0))
      return qd;  // without this, rounding errors would move the joints
    if (arm_.Inverse(X_BW_ * IntegratePose(X_WT_, V_likely_WT, dt_s) * X_TF_,
                     arm_angle_rad + dt_s * turn_rad_per_s, q_, q_next) &&
        (q_next - q_).cwiseAbs().maxCoeff() < params_.joints.jump_rad)
      qd = (q_next - q_) / dt_s;

    qd += moving_ * kinematics::AwayFromLimits<7>(params_.posture, params_.joints.limits,
                                                  params_.joints.position_margin_rad, q_);
    qd += moving_ * kinematics::AwayFromSingularity<7>(params_.posture, sigma_min_m_, sigma_gradient_m_);
    qd += moving_ * load.qd;
  }
  return qd;
}

template <class Arm>
bool JointFollower<Arm>::BrakeJoints() OSTEON_RT {
  if (stop_ticks_ == 0) stop_ticks_ = JointStopTicks(params_);
  --stop_ticks_;
  q_step_ *= static_cast<double>(stop_ticks_) / (stop_ticks_ + 1);
  q_step_ = guard_.Limit(q_, q_step_, params_.period_s).step;
  // a bound may be nearer than the braking distance
  q_step_ *= ZoneScale(q_, q_step_, PointsOf(q_), PointsOf(q_ + q_step_), kAll);
  q_ += q_step_;
  X_WT_ = PoseOf(q_);
  return stop_ticks_ == 0;
}

template <class Arm>
StartStep JointFollower<Arm>::StepToStart(bool permitted) OSTEON_RT {
  const JointPathOutput<kN> next = path_->Step(params_.period_s, permitted);
  const auto guard = guard_.Limit(q_, next.q - q_, params_.period_s);
  if (guard.jump || guard.violated || guard.share < 1.0) return {.refused = Fault::kJointLimit};
  const Points from = PointsOf(q_), to = PointsOf(next.q);
  for (const ZonePoint point : kAll)
    if (workspace_.LeavesZone(point, At(from, point), At(to, point))) return {.refused = Fault::kWorkspace};
  q_ = next.q;
  X_WT_ = PoseOf(q_);
  return {.at_start = next.done, .paused = next.rate == 0.0};
}

template <class Arm>
safety::LimitedWrench JointFollower<Arm>::Limit(const safety::WrenchLimiter& limiter,
                                                const Wrench& F_T_W) const OSTEON_RT {
  if constexpr (kRedundant) {
    if (elbow_.body) {
      const kinematics::Jacobian& J_B = Jacobian();
      kinematics::Jacobian J_W;
      J_W.topRows<3>() = X_WB_.linear() * J_B.topRows<3>();
      J_W.bottomRows<3>() = X_WB_.linear() * J_B.bottomRows<3>();
      return limiter.Limit(
          F_T_W, {J_W, Gravity(), elbow_.load.torque_limit_Nm, kinematics::GravityHelp::kNotCounted});
    }
  }
  return limiter.Limit(F_T_W);
}

}  // namespace

std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params, const kinematics::LbrArm& arm,
                                          const Pose& X_WB, const Pose& X_FT, double arm_angle_rad) {
  return std::make_unique<JointFollower<kinematics::LbrArm>>(
      params, arm, params.arm_body ? &*params.arm_body : nullptr, X_WB, X_FT,
      Redundancy(params, X_WB, X_FT, arm_angle_rad));
}

std::unique_ptr<ArmFollower> MakeFollower(const ServoParams& params, const kinematics::OrthoParallelArm& arm,
                                          const Pose& X_WB, const Pose& X_FT) {
  const kinematics::ChainParams<6> chain = kinematics::ChainFrom(arm.params());
  return std::make_unique<JointFollower<kinematics::OrthoParallelArm>>(params, arm, &chain, X_WB, X_FT,
                                                                       NoRedundancy{});
}

}  // namespace osteon::control
