#include "studies/stability/impedance_arm.h"

#include <cmath>
#include <numbers>

#include "kinematics/serial_chain.h"

namespace osteon::studies {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Joints = kinematics::JointVectorN<7>;
using Chain = kinematics::SerialChain<7>;

// Share of the joints' stiffness that holds the elbow, and damping of the Jacobian's pseudoinverse; the same
// values as in DynamicArm.
constexpr double kNullShare = 0.1, kNullDamping_m = 1e-3;

// exp(A t): the series for a small step, squared repeatedly.
Eigen::MatrixXd Exponential(const Eigen::MatrixXd& A, double t) {
  constexpr int kHalvings = 12, kTerms = 6;
  const Eigen::MatrixXd step = A * (t / (1 << kHalvings));
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(A.rows(), A.cols()), sum = term;
  for (int i = 1; i <= kTerms; ++i) {
    term = term * step / i;
    sum += term;
  }
  for (int i = 0; i < kHalvings; ++i) sum = (sum * sum).eval();
  return sum;
}

}  // namespace

Matrix6 DiagonalOfTwist(double linear, double turning) {
  Matrix6 M = Matrix6::Zero();
  M.diagonal().head<3>().setConstant(linear);
  M.diagonal().tail<3>().setConstant(turning);
  return M;
}

MeanMasses MeanMassesOf(const ImpedanceArmParams& params, double mass_ratio) {
  const Chain arm(params.chain, params.gravity_B);
  const Vector3 p_B = arm.FlangePose(params.q) * params.X_FT.translation();
  const Matrix6 mobility = arm.Mobility(params.q, p_B) / mass_ratio;
  return {3.0 / mobility.topLeftCorner<3, 3>().trace(), 3.0 / mobility.bottomRightCorner<3, 3>().trace()};
}

ImpedanceArm ImpedanceArmAt(const ImpedanceArmParams& params, double mass_ratio) {
  const Chain chain(params.chain, params.gravity_B);
  const Chain::Posture posture = chain.ComputePosture(params.q);
  ImpedanceArm arm;
  arm.J = chain.JacobianAt(posture, posture.X_BF * params.X_FT.translation());
  arm.inertia = mass_ratio * chain.MassMatrix(params.q);

  const hil::DynamicArmParams& arm_params = params.arm;
  Joints joint_damping;
  for (int i = 0; i < 7; ++i)
    joint_damping[i] = 2.0 * arm_params.joint_damping_ratio *
                       std::sqrt(arm_params.stiffness_Nm_per_rad[i] * arm.inertia(i, i));
  if (params.torque) {
    arm.stiffness = arm_params.stiffness_Nm_per_rad.asDiagonal();
    arm.damping = joint_damping.asDiagonal();
    return arm;
  }
  const MeanMasses mean = MeanMassesOf(params, mass_ratio);
  const double ratio = 2.0 * arm_params.cartesian_damping_ratio;
  const Matrix6 K = DiagonalOfTwist(arm_params.stiffness_N_per_m, arm_params.stiffness_Nm_per_rad_turn);
  const Matrix6 D =
      DiagonalOfTwist(ratio * std::sqrt(arm_params.stiffness_N_per_m * mean.linear_kg),
                      ratio * std::sqrt(arm_params.stiffness_Nm_per_rad_turn * mean.turning_kg_m2));
  Matrix6 JJt = arm.J * arm.J.transpose();
  JJt.diagonal().array() += kNullDamping_m * kNullDamping_m;
  const Matrix7 null = Matrix7::Identity() - arm.J.transpose() * JJt.ldlt().solve(arm.J);
  arm.stiffness =
      arm.J.transpose() * K * arm.J + null * kNullShare * arm_params.stiffness_Nm_per_rad.asDiagonal();
  arm.damping = arm.J.transpose() * D * arm.J + null * std::sqrt(kNullShare) * joint_damping.asDiagonal();
  return arm;
}

SampledArm Sample(const ImpedanceArm& arm, double seconds) {
  const Matrix7 inverse = arm.inertia.inverse();
  // The torque, which is constant meanwhile, is the third part of the state: so one exponential gives its
  // effect, too.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(21, 21);
  A.block<7, 7>(0, 7).setIdentity();
  A.block<7, 7>(7, 0) = -inverse * arm.stiffness;
  A.block<7, 7>(7, 7) = -inverse * arm.damping;
  A.block<7, 7>(7, 14) = inverse;
  const Eigen::MatrixXd after = Exponential(A, seconds);
  return {.free = after.topLeftCorner<14, 14>(), .forced = after.topRightCorner<14, 7>()};
}

namespace {

// Momentum of all links (linear, and angular about B's origin), per twist of the base (6 × 6, the links'
// inertia) and per velocity of the joints (6 × 7).
struct BaseMomentum {
  Matrix6 by_base{Matrix6::Zero()};
  Eigen::Matrix<double, 6, 7> by_joints{Eigen::Matrix<double, 6, 7>::Zero()};
};
BaseMomentum MomentumOf(const ImpedanceArmParams& params) {
  const Chain chain(params.chain, params.gravity_B);
  const Chain::Posture posture = chain.ComputePosture(params.q);
  BaseMomentum sum;
  for (int i = 0; i < 7; ++i) {
    const kinematics::LinkInertia& link = params.chain.joints[static_cast<std::size_t>(i)].link;
    const Pose X_BL = chain.LinkPose(posture, i);
    const Vector3 c = X_BL * link.p_LLcm_m;
    const Matrix3 I = X_BL.linear() * link.I_LLcm_kg_m2 * X_BL.linear().transpose();
    // A link's velocity v of the centre of mass and angular velocity w give the momentum (m v, I w + c × m
    // v).
    const auto add = [&](const Vector3& v, const Vector3& w, auto&& column) {
      const Vector3 linear = link.mass_kg * v;
      column.template head<3>() += linear;
      column.template tail<3>() += I * w + c.cross(linear);
    };
    for (int k = 0; k < 3; ++k) {
      add(Vector3::Unit(k), Vector3::Zero(), sum.by_base.col(k));
      add(Vector3::Unit(k).cross(c), Vector3::Unit(k), sum.by_base.col(3 + k));
    }
    for (int j = 0; j <= i; ++j) {
      const Vector3 axis = posture.axis_B(j);
      add(axis.cross(c - posture.p_BL[static_cast<std::size_t>(j)]), axis, sum.by_joints.col(j));
    }
  }
  return sum;
}

}  // namespace

MountedArm OnMount(const ImpedanceArm& arm, const ImpedanceArmParams& params,
                   const hil::FlexibleMountParams& mount, double mass_ratio) {
  const BaseMomentum momentum = MomentumOf(params);
  const Matrix6 base = DiagonalOfTwist(mount.mass_kg, mount.inertia_kg_m2) + mass_ratio * momentum.by_base,
                springs = DiagonalOfTwist(mount.stiffness_N_per_m, mount.stiffness_Nm_per_rad);
  MountedArm mounted{.inertia = MountedArm::Matrix::Zero(),
                     .damping = MountedArm::Matrix::Zero(),
                     .stiffness = MountedArm::Matrix::Zero()};
  mounted.inertia.topLeftCorner<7, 7>() = arm.inertia;
  mounted.inertia.bottomLeftCorner<6, 7>() = mass_ratio * momentum.by_joints;
  mounted.inertia.topRightCorner<7, 6>() = mounted.inertia.bottomLeftCorner<6, 7>().transpose();
  mounted.inertia.bottomRightCorner<6, 6>() = base;
  mounted.stiffness.topLeftCorner<7, 7>() = arm.stiffness;
  mounted.stiffness.bottomRightCorner<6, 6>() = springs;
  mounted.damping.topLeftCorner<7, 7>() = arm.damping;
  for (int i = 0; i < 6; ++i)
    mounted.damping(7 + i, 7 + i) = 2.0 * mount.damping_ratio * std::sqrt(springs(i, i) * base(i, i));
  return mounted;
}

OverlayResponse::OverlayResponse(const ImpedanceArm& arm, const Joints& along, double dead_time_s,
                                 double period_s)
    : periods_(static_cast<int>(dead_time_s / period_s)), period_s_(period_s) {
  AddModes(arm.inertia, arm.damping, arm.stiffness, along, dead_time_s - periods_ * period_s);
}

OverlayResponse::OverlayResponse(const MountedArm& arm, const Joints& along, double dead_time_s,
                                 double period_s)
    : periods_(static_cast<int>(dead_time_s / period_s)), period_s_(period_s) {
  AddModes(arm.inertia, arm.damping, arm.stiffness, along, dead_time_s - periods_ * period_s);
}

// Adds the modes of inertia qdd + damping qd + stiffness q = along f.
// @param rest_s  the rest of the dead time beyond whole periods: a force begins to act so long after a
// period's begin
void OverlayResponse::AddModes(const Eigen::MatrixXd& inertia, const Eigen::MatrixXd& damping,
                               const Eigen::MatrixXd& stiffness, const Joints& along, double rest_s) {
  const Eigen::Index n = inertia.rows();
  const Eigen::PartialPivLU<Eigen::MatrixXd> solved(inertia);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -solved.solve(stiffness);
  A.bottomRightCorner(n, n) = -solved.solve(damping);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(n), drive = Eigen::VectorXd::Zero(2 * n),
                  seen = Eigen::VectorXd::Zero(2 * n);
  torque.head<7>() = along;
  drive.tail(n) = solved.solve(torque);
  seen.head<7>() = along;

  // Decouple the modes; `driven` is the effect of a force along the axis on each mode.
  const Eigen::EigenSolver<Eigen::MatrixXd> eigen(A);
  const Eigen::MatrixXcd V = eigen.eigenvectors();
  const Eigen::VectorXcd driven = V.partialPivLu().solve(drive.cast<std::complex<double>>());
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const std::complex<double> pole = eigen.eigenvalues()[i];
    const std::complex<double> gain =
        (seen.cast<std::complex<double>>().array() * V.col(i).array()).sum() * driven[i];
    // Returns the state of a mode after a constant force of 1 for this time.
    const auto held = [pole](double seconds) {
      return std::abs(pole) * seconds < 1e-9 ? std::complex<double>(seconds)
                                             : (std::exp(pole * seconds) - 1.0) / pole;
    };
    const double newer_s = period_s_ - rest_s;
    modes_.push_back({.free = std::exp(pole * period_s_),
                      .now = gain * held(newer_s),
                      .before = gain * std::exp(pole * newer_s) * held(rest_s)});
  }
}

std::complex<double> OverlayResponse::operator()(double hz) const {
  const std::complex<double> z = std::polar(1.0, 2.0 * std::numbers::pi * hz * period_s_);
  std::complex<double> sum = 0.0;
  for (const Mode& mode : modes_) sum += (mode.now + mode.before / z) / (z - mode.free);
  return std::pow(z, -periods_) * sum;
}

}  // namespace osteon::studies
