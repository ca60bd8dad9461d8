#include "studies/stability/overlay_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "control/coupling/virtual_coupling.h"
#include "kinematics/payload.h"
#include "kinematics/serial_chain.h"
#include "studies/stability/impedance_arm.h"

namespace osteon::studies {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Joints = kinematics::JointVectorN<7>;
using Chain = kinematics::SerialChain<7>;

constexpr double kLever2_m2 = OverlayLoop::lever2_m2();
// The motion counts as grown above this speed, which is some fifty times that of the push. At higher speeds
// the drives' limits would keep the motion from growing.
constexpr double kGrown_m_per_s = 0.1;
// In the simulation: the hand's steady force on the wall; force and duration of the push that starts the
// motion.
constexpr double kPreload_N = 20.0, kPush_N = 1.0, kPush_s = 0.01;

// A matrix for twists (v, w) with these factors along the axes of a frame; R is the frame's rotation.
Matrix6 RotatedDiagonal(const Matrix3& R, const Vector3& linear, const Vector3& turning) {
  Matrix6 M = Matrix6::Zero();
  M.topLeftCorner<3, 3>() = R * linear.asDiagonal() * R.transpose();
  M.bottomRightCorner<3, 3>() = R * turning.asDiagonal() * R.transpose();
  return M;
}

kinematics::ChainParams<7> WithoutFriction(kinematics::ChainParams<7> chain) {
  for (kinematics::RevoluteJoint& joint : chain.joints) joint.friction = {};
  return chain;
}

// The parameters of the arm without a hand.
ImpedanceArmParams OwnArm(const OverlayLoopParams& params) {
  hil::DynamicArmParams arm = params.arm;
  arm.mass_error = 0.0;
  arm.mount.reset();
  return {.chain = WithoutFriction(params.chain),
          .arm = std::move(arm),
          .X_FT = params.X_FT,
          .q = params.q,
          .gravity_B = params.gravity_B,
          .torque = params.torque};
}

// A chain without friction, with the hand's mass at the tool.
kinematics::ChainParams<7> WithHand(const OverlayLoopParams& params) {
  kinematics::ChainParams<7> chain = WithoutFriction(params.chain);
  if (!(params.hand.mass_kg > 0.0)) return chain;
  return kinematics::WithPayload(
      chain, kinematics::LinkInertia{.mass_kg = params.hand.mass_kg,
                                     .p_LLcm_m = params.X_FT.translation(),
                                     .I_LLcm_kg_m2 = kLever2_m2 * params.hand.mass_kg * Matrix3::Identity()});
}

}  // namespace

OverlayLoop::OverlayLoop(const OverlayLoopParams& params) : params_(params) {
  const ImpedanceArmParams own = OwnArm(params);
  const Chain chain(own.chain, params.gravity_B);
  const Pose X_BT = chain.FlangePose(params.q) * params.X_FT;
  axis_B_ = X_BT.linear().col(2);
  mass_kg_ = 1.0 / axis_B_.dot(chain.Mobility(params.q, X_BT.translation()).topLeftCorner<3, 3>() * axis_B_);
  ImpedanceArm arm = ImpedanceArmAt(own);
  arm.inertia = Chain(WithHand(params), params.gravity_B).MassMatrix(params.q);
  J_ = arm.J;
  follow_ = arm.stiffness;
  const SampledArm sampled = Sample(arm, params.period_s);
  free_ = sampled.free;
  forced_ = sampled.forced;
  damping_ = RotatedDiagonal(X_BT.linear(), params.law.damping_Ns_per_m, params.law.damping_Nms_per_rad);
  hand_k_ = DiagonalOfTwist(params.hand.stiffness_N_per_m, kLever2_m2 * params.hand.stiffness_N_per_m);
  hand_b_ = DiagonalOfTwist(params.hand.damping_Ns_per_m, kLever2_m2 * params.hand.damping_Ns_per_m);
  // State: q, qd; the equilibrium; the pose a tick ago; the filtered velocity; torques that were sent and do
  // not act yet; depths in the wall in earlier ticks
  size_ = 14 + 7 + 6 + 6 + 7 * params.arm.dead_cycles + params.wall.age_ticks;
}

Eigen::VectorXd OverlayLoop::Step(const Eigen::VectorXd& s) const {
  const int dead = params_.arm.dead_cycles, age = params_.wall.age_ticks;
  const int equilibrium_at = 14, before_at = 21, velocity_at = 27, sent_at = 33,
            depth_at = sent_at + 7 * dead;
  const double T = params_.period_s;
  const Eigen::Matrix<double, 7, 1> q = s.head<7>(), qd = s.segment<7>(7);
  const Vector6 pose = J_ * q;

  // Step the law: equilibrium, filtered velocity, wall and damping.
  const double follow = T / (T + params_.law.follow_s);
  const Eigen::Matrix<double, 7, 1> equilibrium =
      s.segment<7>(equilibrium_at) + follow * (q - s.segment<7>(equilibrium_at));
  const double share = T / (T + params_.law.twist_filter_s);
  const Vector6 before = s.segment<6>(before_at), filtered = s.segment<6>(velocity_at);
  const Vector6 velocity = filtered + share * ((pose - before) / T - filtered);
  const double depth = axis_B_.dot(pose.head<3>());
  const double wall_depth = age == 0 ? depth : s[depth_at + age - 1];
  Vector6 overlay = -damping_ * velocity;
  overlay.head<3>() -= params_.wall.stiffness_N_per_m * wall_depth * axis_B_;
  const Eigen::Matrix<double, 7, 1> sent = follow_ * equilibrium + J_.transpose() * overlay;

  // Step the arm by a period. The torque is the one that was sent a dead time ago; the hand's force is the
  // present one.
  const Eigen::Matrix<double, 7, 1> acting =
      dead == 0 ? sent : Eigen::Matrix<double, 7, 1>(s.segment<7>(sent_at + 7 * (dead - 1)));
  const Vector6 hand = -hand_k_ * pose - hand_b_ * (J_ * qd);
  Eigen::VectorXd next = Eigen::VectorXd::Zero(size_);
  next.head<14>() = free_ * s.head<14>() + forced_ * (acting + J_.transpose() * hand);
  next.segment<7>(equilibrium_at) = equilibrium;
  next.segment<6>(before_at) = pose;
  next.segment<6>(velocity_at) = velocity;
  for (int i = 0; i < dead; ++i)
    next.segment<7>(sent_at + 7 * i) =
        i == 0 ? sent : Eigen::Matrix<double, 7, 1>(s.segment<7>(sent_at + 7 * (i - 1)));
  for (int i = 0; i < age; ++i) next[depth_at + i] = i == 0 ? depth : s[depth_at + i - 1];
  return next;
}

Eigen::MatrixXd OverlayLoop::Matrix() const {
  return hil::LoopMatrix([this](const Eigen::VectorXd& s) { return Step(s); }, size_);
}

namespace {

// The arm's parameters for a simulation in which the chain carries the hand's mass. DynamicArm derives its
// damping from all masses, but the damping must be that without the hand. So the Cartesian damping is
// corrected by its ratio, and the joints' damping by a torque (see OverlayRun).
hil::DynamicArmParams LoadedArm(const OverlayLoopParams& params) {
  ImpedanceArmParams without_hand = OwnArm(params), with_hand = without_hand;
  with_hand.chain = WithHand(params);
  hil::DynamicArmParams arm = without_hand.arm;
  arm.cartesian_damping_ratio *=
      std::sqrt(MeanMassesOf(without_hand).linear_kg / MeanMassesOf(with_hand).linear_kg);
  arm.dead_cycles = 0;
  arm.substeps = 1;
  return arm;
}

// The joints' damping that DynamicArm derives from the masses of a chain.
Joints JointDamping(const kinematics::ChainParams<7>& chain, const OverlayLoopParams& params) {
  const Joints inertia = Chain(chain, params.gravity_B).MassMatrix(params.q).diagonal();
  return 2.0 * params.arm.joint_damping_ratio *
         params.arm.stiffness_Nm_per_rad.cwiseProduct(inertia).cwiseSqrt();
}

// Simulates the shipped parts in time. A period is divided into kParts steps of the arm, so that the torque
// that corrects the joints' damping follows the joints' speed.
class OverlayRun {
 public:
  static constexpr int kParts = 10;

  explicit OverlayRun(const OverlayLoopParams& params)
      : params_(params),
        chain_(WithHand(params), params.gravity_B),
        arm_(LoadedArm(params), WithHand(params), params.gravity_B, params.X_FT.translation(),
             params.period_s / kParts, params.q),
        excess_damping_(JointDamping(WithHand(params), params) -
                        JointDamping(WithoutFriction(params.chain), params)),
        twist_(params.law.twist_filter_s),
        X_rest_(chain_.FlangePose(params.q) * params.X_FT),
        preload_N_(params.wall.stiffness_N_per_m > 0.0 ? kPreload_N : 0.0) {
    twist_.Reset(X_rest_);
    drive_.q_cmd = params.q;
    drive_.control =
        params.torque ? control::ControlMode::kJointImpedance : control::ControlMode::kCartesianImpedance;
    coupling_.max_stiffness_N_per_m = std::max(1.0, params.wall.stiffness_N_per_m);
    coupling_.damping_Ns_per_m = 0.0;
    coupling_state_.fade = 1.0;
    const Vector3 feed_B = X_rest_.linear().col(2);
    plane_.contact_count = 1;
    plane_.contacts[0].n_W = Vector3(-feed_B);
    plane_.contacts[0].stiffness_N_per_m = params.wall.stiffness_N_per_m;
    if (preload_N_ > 0.0)
      plane_.contacts[0].p_W_m =
          Vector3(X_rest_.translation() - preload_N_ / params.wall.stiffness_N_per_m * feed_B);
    past_.assign(static_cast<std::size_t>(params.wall.age_ticks) + 1, X_rest_);
    sent_.assign(static_cast<std::size_t>(params.arm.dead_cycles) + 1, drive_);
    // Pass the dead time without the preload, so that the wall's force and the preload begin in the same tick
    // and balance.
    for (int i = 0; i < params.arm.dead_cycles; ++i) Advance(0.0, true);
  }

  // Simulates a period with a push by the hand. @returns the size of the tool's velocity [m/s]; a rotation is
  // converted by the lever of a grip.
  // @param resting  true: the hand's preload is left out
  double Advance(double push_N, bool resting = false) {
    const double T = params_.period_s;
    const Pose X_BT = chain_.FlangePose(arm_.q()) * params_.X_FT;
    const Twist& V = twist_.Step(X_BT, T);
    std::rotate(past_.rbegin(), past_.rbegin() + 1, past_.rend());
    past_.front() = X_BT;
    Wrench F = control::DampingWrench(params_.law, X_BT.linear(), V, V);
    F.f += Wall();
    Joints q_cmd = drive_.q_cmd;
    q_cmd += T / (T + params_.law.follow_s) * (arm_.q() - q_cmd);
    drive_.q_cmd = q_cmd;
    const Eigen::Matrix<double, 6, 7> J =
        chain_.JacobianAt(chain_.ComputePosture(arm_.q()), X_BT.translation());
    Eigen::Matrix<double, 6, 1> wrench;
    wrench << F.f, F.t;
    drive_.F_T_B = F;
    drive_.tau_Nm = J.transpose() * wrench;

    const Eigen::Matrix<double, 6, 1> tool_velocity = J * arm_.qd();
    const hil::GridHand& hand = params_.hand;
    const Vector3 feed_B = X_rest_.linear().col(2);
    const Vector3 displacement_m = X_BT.translation() - X_rest_.translation();
    const Vector3 rotation = X_rest_.linear() * LogRotation(X_rest_.linear().transpose() * X_BT.linear());
    Wrench hand_wrench{
        .f = -hand.stiffness_N_per_m * displacement_m - hand.damping_Ns_per_m * tool_velocity.head<3>(),
        .t = -kLever2_m2 *
             (hand.stiffness_N_per_m * rotation + hand.damping_Ns_per_m * tool_velocity.tail<3>())};
    hand_wrench.f +=
        (resting ? 0.0 : preload_N_) * feed_B + push_N * (X_rest_.linear() * Vector3::Ones()).normalized();
    Move(hand_wrench);
    return std::sqrt(tool_velocity.head<3>().squaredNorm() +
                     kLever2_m2 * tool_velocity.tail<3>().squaredNorm());
  }

 private:
  // Moves the arm by a period, with the command that was sent dead_cycles ticks ago.
  void Move(const Wrench& hand_wrench) {
    std::rotate(sent_.rbegin(), sent_.rbegin() + 1, sent_.rend());
    sent_.front() = drive_;
    for (int part = 0; part < kParts; ++part) {
      hil::ArmDrive acting = sent_.back();
      acting.tau_Nm += excess_damping_.cwiseProduct(arm_.qd());
      arm_.Step(acting, hand_wrench);
    }
  }

  // Force of the shipped coupling at the pose of age_ticks ticks ago, in B.
  Vector3 Wall() {
    if (!(params_.wall.stiffness_N_per_m > 0.0)) return Vector3::Zero();
    ++tick_;
    const auto now = static_cast<rt::Nanoseconds>(std::llround(1e9 * params_.period_s * tick_));
    plane_.pose_stamp = now;
    plane_.frame = static_cast<std::uint64_t>(tick_);
    return control::EvaluateCoupling(coupling_, {.model = plane_, .X_WT = past_.back(), .now = now},
                                     coupling_state_)
        .F_T_W.f;
  }

  OverlayLoopParams params_;
  Chain chain_;
  hil::DynamicArm arm_;
  Joints excess_damping_;            // excess of the joints' damping, due to the hand's mass
  std::vector<hil::ArmDrive> sent_;  // commands, newest first
  control::MeasuredTwist twist_;
  Pose X_rest_;
  double preload_N_;
  hil::ArmDrive drive_;
  control::CouplingParams coupling_;
  control::CouplingState coupling_state_;
  simulation::ContactModel plane_;
  std::vector<Pose> past_;  // measured poses, newest first
  double tick_{0.0};
};

}  // namespace

bool OverlayGrows(const OverlayLoopParams& params, double seconds) {
  OverlayRun run(params);
  const int ticks = static_cast<int>(seconds / params.period_s), third = ticks / 3;
  // sums of the squared speed over the middle third and the last third of the run
  double middle = 0.0, last = 0.0;
  for (int k = 0; k < ticks; ++k) {
    const double speed = run.Advance(k * params.period_s < kPush_s ? kPush_N : 0.0);
    if (!std::isfinite(speed) || speed > kGrown_m_per_s) return true;
    if (k >= third) (k < 2 * third ? middle : last) += speed * speed;
  }
  return last > middle;
}

}  // namespace osteon::studies
