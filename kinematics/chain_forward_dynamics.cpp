#include <cassert>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"

// Forward dynamics by articulated bodies, and the Coriolis matrix.

namespace osteon::kinematics {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

Matrix3 Cross(const Vector3& v) {
  Matrix3 C;
  C << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return C;
}

// R A R^T, R being the turn to the parent.
Matrix3 ToParent(const FrameTurn& T, const Matrix3& A) {
  Matrix3 half, whole;
  for (int j = 0; j < 3; ++j) half.row(j) = T.ToParent(A.col(j)).transpose();
  for (int j = 0; j < 3; ++j) whole.row(j) = T.ToParent(half.col(j)).transpose();
  return whole;
}

// What a link with all that hangs on it, joints free, asks for: torque = J wd + H a + torque0 and force = H^T
// wd + M a
// + force0, at its origin.
struct Articulated {
  Matrix3 J, H, M;
  Vector3 torque, force;
};

}  // namespace

// Accelerations are those of the link's origin and of the link's turning, not spatial ones: the bias of a
// body is w × J w and w × (w × h), and that of a joint w × z qd and w × (w × p).
template <int N>
JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints& q, const Joints& qd,
                                                const Joints& tau) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = Turns(q);
  std::array<Articulated, static_cast<std::size_t>(N)> bodies;
  std::array<Vector3, static_cast<std::size_t>(N)> wd_bias, a_bias, U_torque, U_force;
  std::array<double, static_cast<std::size_t>(N)> u, D;

  // outwards: turning, bias of bodies and joints
  Vector3 w = Vector3::Zero();
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    a_bias[i] = T.ToChild(w.cross(w.cross(step.p)));
    w = T.ToChild(w);
    const double rate = qd[static_cast<int>(i)];
    wd_bias[i] = Vector3(w.y() * rate, -w.x() * rate, 0.0);
    w.z() += rate;
    const Body& body = bodies_[i];
    bodies[i] = {body.inertia_kg_m2, Cross(body.first_moment_kg_m), body.mass_kg * Matrix3::Identity(),
                 w.cross(body.inertia_kg_m2 * w), w.cross(w.cross(body.first_moment_kg_m))};
  }

  // inwards: what remains of a body once its joint gives way
  for (std::size_t i = N; i-- > 0;) {
    Articulated& body = bodies[i];
    U_torque[i] = body.J.col(2);
    U_force[i] = body.H.row(2).transpose();
    D[i] = body.J(2, 2) + params_.joints[i].rotor_inertia_kg_m2;
    u[i] = tau[static_cast<int>(i)] - body.torque.z();
    if (i == 0) break;
    const Vector3 t = U_torque[i] / D[i], f = U_force[i] / D[i];
    body.J -= U_torque[i] * t.transpose();
    body.H -= U_torque[i] * f.transpose();
    body.M -= U_force[i] * f.transpose();
    body.torque += body.J * wd_bias[i] + body.H * a_bias[i] + u[i] * t;
    body.force += body.H.transpose() * wd_bias[i] + body.M * a_bias[i] + u[i] * f;

    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    const Matrix3 J = ToParent(T, body.J), H = ToParent(T, body.H), M = ToParent(T, body.M);
    const Matrix3 P = Cross(step.p), H_moved = H + P * M;
    const Vector3 force = T.ToParent(body.force);
    Articulated& parent = bodies[i - 1];
    parent.J += J - H * P + P * H_moved.transpose();
    parent.H += H_moved;
    parent.M += M;
    parent.torque += T.ToParent(body.torque) + step.p.cross(force);
    parent.force += force;
  }

  // outwards: accelerations
  Joints qdd;
  Vector3 wd = Vector3::Zero(), a = lift_K0_;
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    a = T.ToChild(a + wd.cross(step.p)) + a_bias[i];
    wd = T.ToChild(wd) + wd_bias[i];
    const double rate = (u[i] - U_torque[i].dot(wd) - U_force[i].dot(a)) / D[i];
    wd.z() += rate;
    qdd[static_cast<int>(i)] = rate;
  }
  return qdd;
}

template <int N>
JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints& q, const Joints& qd, const Joints& tau,
                                                const Wrench& F_ext_B) const noexcept {
  return ForwardDynamics(q, qd, tau + TorquesOf(Place(q), F_ext_B));
}

// C = sum over the links k of J_k^T (I_k Jd_k + B_k J_k), with spatial vectors (turning, then velocity at the
// base's origin) and all in B, and B_k = 1/2 ((v ×*) I + (I v) ×̄* - I (v ×)).
template <int N>
JointMatrixN<N> SerialChain<N>::CoriolisMatrix(const Joints& q, const Joints& qd) const noexcept {
  assert(params_.has_masses);
  const Posture posture = Place(q);
  std::array<Vector6, static_cast<std::size_t>(N)> S, S_dot;
  std::array<Matrix6, static_cast<std::size_t>(N)> I, B;
  Vector6 v = Vector6::Zero();
  for (std::size_t i = 0; i < N; ++i) {
    const Vector3 axis = posture.R_BK[i].col(2), p = posture.p_BL[i];
    S[i] << axis, p.cross(axis);
    v += qd[static_cast<int>(i)] * S[i];
    Matrix6 motion;  // v ×
    motion << Cross(v.template head<3>()), Matrix3::Zero(), Cross(v.template tail<3>()),
        Cross(v.template head<3>());
    S_dot[i].noalias() = motion.lazyProduct(S[i]);

    // the link's inertia in B
    const Body& body = bodies_[i];
    const Matrix3& R = posture.R_BK[i];
    const Vector3 turned = R * body.first_moment_kg_m, h = turned + body.mass_kg * p;
    const Matrix3 second =
        R * body.second_moment_kg_m2 * R.transpose() + turned * p.transpose() + p * h.transpose();
    I[i] << second.trace() * Matrix3::Identity() - second, Cross(h), -Cross(h),
        body.mass_kg * Matrix3::Identity();

    const Vector6 momentum = I[i].lazyProduct(v);
    Matrix6 momentum_cross;  // m -> m ×* (I v)
    momentum_cross << -Cross(momentum.template head<3>()), -Cross(momentum.template tail<3>()),
        -Cross(momentum.template tail<3>()), Matrix3::Zero();
    const Matrix6 I_motion = I[i].lazyProduct(motion);  // (v ×*) = -(v ×)^T
    B[i] = 0.5 * (momentum_cross - I_motion.transpose() - I_motion);
  }

  JointMatrixN<N> C;
  for (std::size_t j = N; j-- > 0;) {
    if (j + 1 < N) {
      I[j] += I[j + 1];
      B[j] += B[j + 1];
    }
    const Vector6 own = I[j].lazyProduct(S_dot[j]) + B[j].lazyProduct(S[j]);
    const Vector6 inertial = I[j].lazyProduct(S[j]), turned = B[j].transpose().lazyProduct(S[j]);
    for (std::size_t i = 0; i <= j; ++i) {
      C(static_cast<int>(i), static_cast<int>(j)) = S[i].dot(own);
      if (i < j) C(static_cast<int>(j), static_cast<int>(i)) = S_dot[i].dot(inertial) + S[i].dot(turned);
    }
  }
  return C;
}

#define OSTEON_INSTANTIATE(N)                                                                           \
  template JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints&, const Joints&, const Joints&) \
      const noexcept;                                                                                   \
  template JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints&, const Joints&, const Joints&, \
                                                           const Wrench&) const noexcept;               \
  template JointMatrixN<N> SerialChain<N>::CoriolisMatrix(const Joints&, const Joints&) const noexcept;
OSTEON_INSTANTIATE(6)
OSTEON_INSTANTIATE(7)
#undef OSTEON_INSTANTIATE

}  // namespace osteon::kinematics
