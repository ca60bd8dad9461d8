#include "kinematics/serial_chain.h"

#include <cmath>

#include "kinematics/check_chain.h"
#include "kinematics/payload.h"

namespace osteon::kinematics {
namespace {

// axes count as parallel if the sine of their angle is smaller: rounding in a robot description
constexpr double kParallel = 1e-14;

// Unit vector perpendicular to a unit vector.
Vector3 AnyNormal(const Vector3& z) {
  Eigen::Index least;
  z.cwiseAbs().minCoeff(&least);
  const Vector3 e = Vector3::Unit(least);
  return (e - z.dot(e) * z).normalized();
}

// Rotation matrix of the frame with these perpendicular unit axes.
Matrix3 FrameOf(const Vector3& x, const Vector3& z) {
  Matrix3 R;
  R << x, z.cross(x), z;
  return R;
}

// A frame that is moved along the chain, joint by joint: its axes and origin, in B.
struct Walker {
  Vector3 x, y, z, p;

  // X = X Translation(step) Rx(alpha) Rz(q)
  [[gnu::always_inline]] void Go(const Vector3& step, double cos_alpha, double sin_alpha, double cos_q,
                                 double sin_q) {
    p += step.x() * x + step.y() * y + step.z() * z;
    const Vector3 tilted = cos_alpha * y + sin_alpha * z;
    z = cos_alpha * z - sin_alpha * y;
    y = cos_q * tilted - sin_q * x;
    x = cos_q * x + sin_q * tilted;
  }
};

// Fills the Jacobian of the point of the flange that is now at p_B.
template <int N>
[[gnu::always_inline]] inline void FillJacobian(const typename SerialChain<N>::Posture& posture,
                                                const Vector3& p_B, JacobianN<N>& J) {
  for (int i = 0; i < N; ++i) {
    const Vector3 axis = posture.axis_B(i);
    J.col(i).template head<3>() = axis.cross(p_B - posture.p_BL[static_cast<std::size_t>(i)]);
    J.col(i).template tail<3>() = axis;
  }
}

}  // namespace

template <int N>
SerialChain<N>::SerialChain(const ChainParams<N>& params, const Vector3& gravity_B) : params_(params) {
  CheckChain(params);
  const auto joint = [&](int i) -> const RevoluteJoint& {
    return params.joints[static_cast<std::size_t>(i)];
  };

  Vector3 z_before = (joint(0).X_PJ.linear() * joint(0).axis_J).normalized();  // axes of K(i-1) in L(i-1)
  Vector3 x_before = AnyNormal(z_before);
  R_BK0_ = FrameOf(x_before, z_before);
  Matrix3 R_LK = R_BK0_;
  for (int i = 0; i < N; ++i) {
    const Matrix3 R_PJ = joint(i).X_PJ.linear();
    const Vector3 z = joint(i).axis_J.normalized();
    Step& step = steps_[static_cast<std::size_t>(i)];
    step.p = R_LK.transpose() * joint(i).X_PJ.translation();
    const Vector3 z_P = R_PJ * z;
    step.cos_alpha = z_before.dot(z_P);
    step.sin_alpha = x_before.dot(z_before.cross(z_P));

    // Choose x of K(i) along z_i × z_(i+1), with the sign that gives the smaller offset; for parallel axes
    // keep the previous frame's x, which gives no offset. The variable unturned is the previous frame's x, in
    // the link's frame at q = 0.
    const Vector3 unturned = R_PJ.transpose() * x_before;
    Vector3 x = unturned;
    if (i + 1 < N) {
      const Vector3 normal = z.cross(joint(i + 1).X_PJ.linear() * joint(i + 1).axis_J);
      if (normal.norm() > kParallel) x = normal.normalized();
    }
    if (x.dot(unturned) < 0.0) x = -x;
    step.offset_rad = std::atan2(z.dot(unturned.cross(x)), unturned.dot(x));

    R_LK = FrameOf(x, z);
    R_LK_[static_cast<std::size_t>(i)] = R_LK;
    const LinkInertia& link = joint(i).link;
    Body& body = bodies_[static_cast<std::size_t>(i)];
    const Vector3 p_KKcm = R_LK.transpose() * link.p_LLcm_m;
    body.mass_kg = link.mass_kg;
    body.first_moment_kg_m = link.mass_kg * p_KKcm;
    body.inertia_kg_m2 = R_LK.transpose() * link.I_LLcm_kg_m2 * R_LK + PointInertia(link.mass_kg, p_KKcm);
    body.second_moment_kg_m2 = 0.5 * body.inertia_kg_m2.trace() * Matrix3::Identity() - body.inertia_kg_m2;
    x_before = x;
    z_before = z;
  }
  lift_K0_ = -(R_BK0_.transpose() * gravity_B);
  R_KF_ = R_LK.transpose() * params.X_LF.linear();
  p_KF_ = R_LK.transpose() * params.X_LF.translation();
}

template <int N>
template <class Visit>
[[gnu::always_inline]] inline Pose SerialChain<N>::Walk(const Joints& q, const Visit& visit) const noexcept {
  const SinCosN<kPadded> turn = SinCosOfTurns(q);
  Walker at{R_BK0_.col(0), R_BK0_.col(1), R_BK0_.col(2), Vector3::Zero()};
  for (std::size_t i = 0; i < N; ++i) {
    at.Go(steps_[i].p, steps_[i].cos_alpha, steps_[i].sin_alpha, turn.cos[i], turn.sin[i]);
    visit(i, at.x, at.y, at.z, at.p);
  }
  Pose X_BF;
  X_BF.makeAffine();
  for (int j = 0; j < 3; ++j)
    X_BF.linear().col(j) = R_KF_(0, j) * at.x + R_KF_(1, j) * at.y + R_KF_(2, j) * at.z;
  X_BF.translation() = at.p + (p_KF_.x() * at.x + p_KF_.y() * at.y + p_KF_.z() * at.z);
  return X_BF;
}

template <int N>
void SerialChain<N>::ComputePosture(const Joints& q, Posture& posture) const noexcept {
  posture.X_BF =
      Walk(q, [&](std::size_t i, const Vector3& x, const Vector3& y, const Vector3& z, const Vector3& p) {
        posture.R_BK[i].col(0) = x;
        posture.R_BK[i].col(1) = y;
        posture.R_BK[i].col(2) = z;
        posture.p_BL[i] = p;
      });
}

template <int N>
typename SerialChain<N>::Posture SerialChain<N>::ComputePosture(const Joints& q) const noexcept {
  Posture posture;
  ComputePosture(q, posture);
  return posture;
}

template <int N>
Pose SerialChain<N>::FlangePose(const Joints& q) const noexcept {
  return Walk(q, [](std::size_t, const Vector3&, const Vector3&, const Vector3&, const Vector3&) {});
}

template <int N>
Pose SerialChain<N>::LinkPose(const Posture& posture, int i) const noexcept {
  const auto link = static_cast<std::size_t>(i);
  Pose X_BL;
  X_BL.makeAffine();
  X_BL.linear() = posture.R_BK[link] * R_LK_[link].transpose();
  X_BL.translation() = posture.p_BL[link];
  return X_BL;
}

template <int N>
void SerialChain<N>::Jacobian(const Posture& posture, JacobianN<N>& J) const noexcept {
  FillJacobian<N>(posture, posture.X_BF.translation(), J);
}

template <int N>
JacobianN<N> SerialChain<N>::Jacobian(const Posture& posture) const noexcept {
  JacobianN<N> J;
  Jacobian(posture, J);
  return J;
}

template <int N>
JacobianN<N> SerialChain<N>::JacobianAt(const Posture& posture, const Vector3& p_B) const noexcept {
  JacobianN<N> J;
  FillJacobian<N>(posture, p_B, J);
  return J;
}

template <int N>
JointVectorN<N> SerialChain<N>::TorquesOf(const Posture& posture, const Wrench& F_B) const noexcept {
  Joints tau;
  for (int i = 0; i < N; ++i) {
    const Vector3 arm = posture.X_BF.translation() - posture.p_BL[static_cast<std::size_t>(i)];
    tau[i] = posture.axis_B(i).dot(F_B.t + arm.cross(F_B.f));
  }
  return tau;
}

// Instantiates the functions defined in this file; the dynamics are instantiated in their own files.
template class SerialChain<6>;
template class SerialChain<7>;

}  // namespace osteon::kinematics
