#include "hil/arm/flexible_mount.h"

#include <cmath>

#include <Eigen/Cholesky>

#include "base/parameter_check.h"

namespace osteon::hil {
namespace {

// Matrix of the cross product: Skew(v) u = v × u.
Matrix3 Skew(const Vector3& v) {
  Matrix3 S;
  S << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return S;
}

}  // namespace

FlexibleMount::FlexibleMount(const FlexibleMountParams& params, const kinematics::ChainParams<7>& chain,
                             const Vector3& gravity_B, const Joints& q_start)
    : gravity_B_(gravity_B) {
  const base::ParameterCheck require("mount ");
  require("stiffness_N_per_m", params.stiffness_N_per_m, params.stiffness_N_per_m > 0.0, "> 0");
  require("stiffness_Nm_per_rad", params.stiffness_Nm_per_rad, params.stiffness_Nm_per_rad > 0.0, "> 0");
  require("damping_ratio", params.damping_ratio, params.damping_ratio >= 0.0, ">= 0");
  require("mass_kg", params.mass_kg, params.mass_kg > 0.0, "> 0");
  require("inertia_kg_m2", params.inertia_kg_m2, params.inertia_kg_m2 > 0.0, "> 0");
  for (std::size_t i = 0; i < links_.size(); ++i) links_[i] = chain.joints[i].link;

  mount_inertia_.setZero();
  mount_inertia_.diagonal() << Vector3::Constant(params.mass_kg), Vector3::Constant(params.inertia_kg_m2);
  stiffness_ << Vector3::Constant(params.stiffness_N_per_m), Vector3::Constant(params.stiffness_Nm_per_rad);
  const RigidBodySum sum = SumLinks(kinematics::SerialChain<7>(chain, gravity_B), q_start, Joints::Zero());
  damping_ = 2.0 * params.damping_ratio *
             (stiffness_.array() * (mount_inertia_ + sum.inertia).diagonal().array()).sqrt();
  weight_start_ = sum.weight;
}

FlexibleMount::RigidBodySum FlexibleMount::SumLinks(const kinematics::SerialChain<7>& chain, const Joints& q,
                                                    const Joints& qd) const OSTEON_RT {
  RigidBodySum sum;
  const kinematics::SerialChain<7>::Posture posture = chain.ComputePosture(q);
  // angular velocity of the link and velocity of its origin, in B
  Vector3 w = Vector3::Zero(), v = Vector3::Zero(), p_before = Vector3::Zero();
  for (int i = 0; i < 7; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vector3 p = posture.p_BL[at];
    v += w.cross(p - p_before);  // velocity of this link's origin, which lies on its joint's axis
    w += qd[i] * posture.axis_B(i);
    p_before = p;
    const kinematics::LinkInertia& link = links_[at];
    const Pose X_BL = chain.LinkPose(posture, i);
    // position of the centre of mass: r from the link's origin, c from B's origin
    const Vector3 r = X_BL.linear() * link.p_LLcm_m, c = p + r;
    const Matrix3 I = X_BL.linear() * link.I_LLcm_kg_m2 * X_BL.linear().transpose();
    const Vector3 momentum = link.mass_kg * (v + w.cross(r)), weight = link.mass_kg * gravity_B_;
    const Matrix3 C = Skew(c);
    sum.inertia.topLeftCorner<3, 3>() += link.mass_kg * Matrix3::Identity();
    sum.inertia.topRightCorner<3, 3>() -= link.mass_kg * C;
    sum.inertia.bottomLeftCorner<3, 3>() += link.mass_kg * C;
    sum.inertia.bottomRightCorner<3, 3>() += I - link.mass_kg * C * C;
    sum.momentum.head<3>() += momentum;
    sum.momentum.tail<3>() += c.cross(momentum) + I * w;
    sum.weight.head<3>() += weight;
    sum.weight.tail<3>() += c.cross(weight);
  }
  return sum;
}

void FlexibleMount::Step(const kinematics::SerialChain<7>& chain, const Input& input, double dt_s) OSTEON_RT {
  const auto& [q, qd, F_B, p_B] = input;
  const RigidBodySum sum = SumLinks(chain, q, qd);
  Vector6 outside;
  outside << F_B.f, F_B.t + p_B.cross(F_B.f);
  const Matrix6 inertia = mount_inertia_ + sum.inertia;

  // Backward Euler step of the total momentum of base and arm (inertia × rate + H) under springs, dampers,
  // weight and external wrench.
  Matrix6 left = inertia;
  left.diagonal() += dt_s * damping_ + dt_s * dt_s * stiffness_;
  const Vector6 rate = left.ldlt().solve(
      momentum_ + dt_s * (outside + sum.weight - weight_start_ - stiffness_.cwiseProduct(d_)) - sum.momentum);
  acceleration_ = (rate - rate_) / dt_s;
  rate_ = rate;
  d_ += dt_s * rate_;
  momentum_ = inertia * rate_ + sum.momentum;
}

FlexibleMount::Joints FlexibleMount::Torques(const kinematics::SerialChain<7>& chain,
                                             const Joints& q) const OSTEON_RT {
  const kinematics::SerialChain<7>::Posture posture = chain.ComputePosture(q);
  const Vector3 a = acceleration_.head<3>(), alpha = acceleration_.tail<3>();
  Joints tau;
  // f, t: wrench that the links from joint i on need to accelerate with the base; t about B's origin
  Vector3 f = Vector3::Zero(), t = Vector3::Zero();
  for (int i = 6; i >= 0; --i) {
    const auto at = static_cast<std::size_t>(i);
    const kinematics::LinkInertia& link = links_[at];
    const Pose X_BL = chain.LinkPose(posture, i);
    const Vector3 c = X_BL * link.p_LLcm_m;
    const Vector3 f_i = link.mass_kg * (a + alpha.cross(c));
    f += f_i;
    t += c.cross(f_i) + X_BL.linear() * (link.I_LLcm_kg_m2 * (X_BL.linear().transpose() * alpha));
    tau[i] = posture.axis_B(i).dot(t - posture.p_BL[at].cross(f));
  }
  return tau;
}

Pose FlexibleMount::X_BBnow() const OSTEON_RT {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(d_.tail<3>());
  X.translation() = d_.head<3>();
  return X;
}

}  // namespace osteon::hil
