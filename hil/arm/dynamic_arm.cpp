#include "hil/arm/dynamic_arm.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Cholesky>

#include "base/parameter_check.h"

namespace osteon::hil {
namespace {

using Joints = kinematics::JointVectorN<7>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr double kNullShare = 0.1;       // stiffness in the null space, as a share of the joints' stiffness
constexpr double kNullDamping_m = 1e-3;  // damping of the projection to the null space, for singular postures

// The chain with masses and inertias multiplied by 1 + error.
kinematics::ChainParams<7> WithMassError(kinematics::ChainParams<7> chain, double error) {
  for (kinematics::RevoluteJoint& joint : chain.joints) {
    joint.link.mass_kg *= 1.0 + error;
    joint.link.I_LLcm_kg_m2 *= 1.0 + error;
  }
  return chain;
}

// Returns the parameters; throws where one is not accepted.
const DynamicArmParams& Checked(const DynamicArmParams& params, const kinematics::ChainParams<7>& chain,
                                double period_s) {
  const base::ParameterCheck require("simulated arm: ");
  require("bandwidth_hz", params.bandwidth_hz, params.bandwidth_hz > 0.0 && params.bandwidth_hz <= 200.0,
          "0 … 200, not 0");
  require("damping_ratio", params.damping_ratio, params.damping_ratio >= 0.0 && params.damping_ratio <= 10.0,
          "0 … 10");
  require("dead_cycles", params.dead_cycles,
          params.dead_cycles >= 0 && params.dead_cycles <= DynamicArm::kMaxDeadCycles, "0 … 32");
  for (int i = 0; i < 7; ++i)
    require("stiffness_Nm_per_rad of A" + std::to_string(i + 1), params.stiffness_Nm_per_rad[i],
            params.stiffness_Nm_per_rad[i] >= 0.0 && params.stiffness_Nm_per_rad[i] <= 1e5, "0 … 100000");
  require("joint_damping_ratio", params.joint_damping_ratio, params.joint_damping_ratio >= 0.0, ">= 0");
  require("stiffness_N_per_m", params.stiffness_N_per_m, params.stiffness_N_per_m >= 0.0, ">= 0");
  require("stiffness_Nm_per_rad_turn", params.stiffness_Nm_per_rad_turn,
          params.stiffness_Nm_per_rad_turn >= 0.0, ">= 0");
  require("cartesian_damping_ratio", params.cartesian_damping_ratio, params.cartesian_damping_ratio >= 0.0,
          ">= 0");
  require("mass_error", params.mass_error, params.mass_error > -1.0 && params.mass_error <= 1.0, "-1 … 1");
  require("friction_compensation", params.friction_compensation,
          params.friction_compensation >= 0.0 && params.friction_compensation <= 1.0, "0 … 1");
  require("substeps", params.substeps, params.substeps >= 1 && params.substeps <= 1000, "1 … 1000");
  require("period_s", period_s, period_s > 0.0 && period_s <= 0.1, "0 … 0.1, not 0");
  require("masses", chain.has_masses ? 1.0 : 0.0, chain.has_masses, "an arm's with masses");
  for (int i = 0; i < 7; ++i) {
    const double torque_Nm = chain.joints[static_cast<std::size_t>(i)].limits.torque_Nm;
    require("torque_Nm of A" + std::to_string(i + 1), torque_Nm, torque_Nm > 0.0, "> 0");
  }
  return params;
}

}  // namespace

DynamicArm::DynamicArm(const DynamicArmParams& params, const kinematics::ChainParams<7>& chain,
                       const Vector3& gravity_B, const Vector3& p_FT_m, double period_s,
                       const kinematics::JointVectorN<7>& q_start)
    : params_(Checked(params, chain, period_s)),
      period_s_(period_s),
      arm_(chain, gravity_B),
      model_(WithMassError(chain, params.mass_error), gravity_B),
      p_FT_m_(p_FT_m),
      q_(q_start),
      qd_(Joints::Zero()),
      delay_size_(static_cast<std::size_t>(params.dead_cycles) + 1) {
  for (int i = 0; i < 7; ++i)
    torque_limit_Nm_[i] = chain.joints[static_cast<std::size_t>(i)].limits.torque_Nm;
  if (params.mount) mount_.emplace(*params.mount, chain, gravity_B, q_start);

  const kinematics::JointMatrixN<7> M = arm_.MassMatrix(q_start);
  for (int i = 0; i < 7; ++i)
    joint_damping_[i] =
        2.0 * params.joint_damping_ratio * std::sqrt(params.stiffness_Nm_per_rad[i] * M(i, i));
  const Vector3 p_B = arm_.FlangePose(q_start) * p_FT_m;
  const Eigen::Matrix<double, 6, 6> mobility = arm_.Mobility(q_start, p_B);
  // The damping ratio refers to the apparent mass and inertia at the tool, averaged over the directions.
  const double mass_kg = 3.0 / mobility.topLeftCorner<3, 3>().trace();
  const double inertia_kg_m2 = 3.0 / mobility.bottomRightCorner<3, 3>().trace();
  cartesian_damping_Ns_per_m_ =
      2.0 * params.cartesian_damping_ratio * std::sqrt(params.stiffness_N_per_m * mass_kg);
  cartesian_damping_Nms_per_rad_ =
      2.0 * params.cartesian_damping_ratio * std::sqrt(params.stiffness_Nm_per_rad_turn * inertia_kg_m2);
  tau_ = arm_.Gravity(q_start);
  ArmDrive hold;
  hold.q_cmd = q_start;
  delay_.fill(hold);
}

void DynamicArm::Step(const ArmDrive& drive, const Wrench& F_T_B) OSTEON_RT {
  // Store the newest command, and use the one that came dead_cycles earlier.
  delay_[next_] = drive;
  next_ = (next_ + 1) % delay_size_;
  const ArmDrive& delayed = delay_[next_];

  const double h = period_s_ / params_.substeps;
  for (int k = 0; k < params_.substeps; ++k) {
    const Joints tau_base = mount_ ? mount_->Torques(arm_, q_) : Joints::Zero();
    // Runge-Kutta of fourth order: v2 … v4 and a1 … a4 are velocities and accelerations of its stages
    const auto rate = [&](const Joints& q, const Joints& qd) {
      return Acceleration(delayed, F_T_B, tau_base, q, qd);
    };
    const Joints a1 = rate(q_, qd_);
    const Joints v2 = qd_ + 0.5 * h * a1, a2 = rate(q_ + 0.5 * h * qd_, v2);
    const Joints v3 = qd_ + 0.5 * h * a2, a3 = rate(q_ + 0.5 * h * v2, v3);
    const Joints v4 = qd_ + h * a3, a4 = rate(q_ + h * v3, v4);
    q_ += h / 6.0 * (qd_ + 2.0 * v2 + 2.0 * v3 + v4);
    qd_ += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    if (mount_)
      mount_->Step(arm_, {.q = q_, .qd = qd_, .F_B = F_T_B, .p_B = arm_.FlangePose(q_) * p_FT_m_}, h);
  }
  qdd_ = Acceleration(delayed, F_T_B, mount_ ? mount_->Torques(arm_, q_) : Joints::Zero(), q_, qd_);
  // the torque sensors are on the output side of the gears, where friction is already lost
  tau_ = DriveTorque(delayed, q_, qd_) - arm_.Friction(qd_);
}

// The controller's torque command to the drives.
DynamicArm::Joints DynamicArm::Command(const ArmDrive& drive, const Joints& q,
                                       const Joints& qd) const OSTEON_RT {
  switch (drive.control) {
    case control::ControlMode::kNone:
    case control::ControlMode::kPosition: {
      const double w = 2.0 * std::numbers::pi * params_.bandwidth_hz;
      return model_.InverseDynamics(q, qd, w * w * (drive.q_cmd - q) - 2.0 * params_.damping_ratio * w * qd);
    }
    case control::ControlMode::kJointImpedance:
      return params_.stiffness_Nm_per_rad.cwiseProduct(drive.q_cmd - q) - joint_damping_.cwiseProduct(qd) +
             model_.InverseDynamics(q, qd, Joints::Zero()) + drive.tau_Nm;
    case control::ControlMode::kCartesianImpedance:
      return CartesianTorque(drive, q, qd) + model_.InverseDynamics(q, qd, Joints::Zero());
  }
  return Joints::Zero();
}

// Torques of the springs and dampers at the tool, of the wrench overlay, and of the joints' springs and
// dampers in the null space.
DynamicArm::Joints DynamicArm::CartesianTorque(const ArmDrive& drive, const Joints& q,
                                               const Joints& qd) const OSTEON_RT {
  const Chain::Posture posture = model_.ComputePosture(q);
  const Vector3 p_B = posture.X_BF * p_FT_m_;
  const kinematics::JacobianN<7> J = model_.JacobianAt(posture, p_B);
  const Pose X_wanted = model_.FlangePose(drive.q_cmd);
  const Vector6 V = J * qd;
  Vector6 F;
  F.head<3>() = params_.stiffness_N_per_m * (X_wanted * p_FT_m_ - p_B) -
                cartesian_damping_Ns_per_m_ * V.head<3>() + drive.F_T_B.f;
  F.tail<3>() = params_.stiffness_Nm_per_rad_turn * posture.X_BF.linear() *
                    LogRotation(posture.X_BF.linear().transpose() * X_wanted.linear()) -
                cartesian_damping_Nms_per_rad_ * V.tail<3>() + drive.F_T_B.t;

  // Remove from the torques of the joints' springs and dampers those components that would move the flange.
  // The projection is damped, so a small part remains.
  const Joints tau_null = kNullShare * params_.stiffness_Nm_per_rad.cwiseProduct(drive.q_cmd - q) -
                          std::sqrt(kNullShare) * joint_damping_.cwiseProduct(qd);
  Eigen::Matrix<double, 6, 6> JJt = J * J.transpose();
  JJt.diagonal().array() += kNullDamping_m * kNullDamping_m;
  return J.transpose() * F + tau_null - J.transpose() * JJt.ldlt().solve(J * tau_null);
}

// The controller's torque command plus its friction compensation, limited to the drives' maximum torques.
DynamicArm::Joints DynamicArm::DriveTorque(const ArmDrive& drive, const Joints& q,
                                           const Joints& qd) const OSTEON_RT {
  return (Command(drive, q, qd) + params_.friction_compensation * arm_.Friction(qd))
      .cwiseMin(torque_limit_Nm_)
      .cwiseMax(-torque_limit_Nm_);
}

// @param tau_base torques that the drives need because the base accelerates
DynamicArm::Joints DynamicArm::Acceleration(const ArmDrive& drive, const Wrench& F_T_B,
                                            const Joints& tau_base, const Joints& q,
                                            const Joints& qd) const OSTEON_RT {
  const Joints tau = DriveTorque(drive, q, qd) - arm_.Friction(qd) - tau_base;
  const Vector3 p_FT_B = arm_.FlangePose(q).linear() * p_FT_m_;
  return arm_.ForwardDynamics(q, qd, tau, {.f = F_T_B.f, .t = F_T_B.t + p_FT_B.cross(F_T_B.f)});
}

DynamicArm::Joints DynamicArm::tau_external_Nm() const OSTEON_RT {
  return model_.InverseDynamics(q_, qd_, qdd_) - tau_;
}

Pose DynamicArm::X_BBnow() const OSTEON_RT { return mount_ ? mount_->X_BBnow() : Pose::Identity(); }

}  // namespace osteon::hil
