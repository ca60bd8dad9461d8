#include <cassert>
#include <cmath>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"
#include "kinematics/sin_cos.h"

// Inverse dynamics, link by link in the links' own frames, where what is fixed needs no turning.

namespace osteon::kinematics {

// Newton-Euler, outwards for the motion, inwards for the forces. A point r of a link accelerates by a + A r,
// where
//
//     A = [wd] + [w][w] = [wd] + w w^T - |w|^2 1
//
// serves three times: for the next link's origin, for the force m a + A h, and with the second moments S for
// the torque about the origin, which is the integral of r × (a + A r) dm: h × a + skew part of A S.
template <int N>
template <bool kMoving>
JointVectorN<N> SerialChain<N>::NewtonEuler(const Joints& q, const Joints& qd, const Joints& qdd,
                                            const Vector3& a_base) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = Turns(q);
  std::array<Vector3, static_cast<std::size_t>(N)> force, torque;
  Vector3 w = Vector3::Zero(), wd = Vector3::Zero(), a = a_base;
  Matrix3 A = Matrix3::Zero();
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    const Body& body = bodies_[i];
    const Vector3& h = body.first_moment_kg_m;
    if constexpr (kMoving) {
      a = T.ToChild(a + A * step.p);
      w = T.ToChild(w);
      wd = T.ToChild(wd);
      const double rate = qd[static_cast<int>(i)];
      wd += Vector3(w.y() * rate, -w.x() * rate, qdd[static_cast<int>(i)]);
      w.z() += rate;

      const double xx = w.x() * w.x(), yy = w.y() * w.y(), zz = w.z() * w.z();
      const double xy = w.x() * w.y(), xz = w.x() * w.z(), yz = w.y() * w.z();
      A << -yy - zz, xy - wd.z(), xz + wd.y(),  //
          xy + wd.z(), -xx - zz, yz - wd.x(),   //
          xz - wd.y(), yz + wd.x(), -xx - yy;
      const Matrix3& S = body.second_moment_kg_m2;
      force[i] = body.mass_kg * a + A * h;
      torque[i] = h.cross(a) + Vector3(A.row(2).dot(S.col(1)) - A.row(1).dot(S.col(2)),
                                       A.row(0).dot(S.col(2)) - A.row(2).dot(S.col(0)),
                                       A.row(1).dot(S.col(0)) - A.row(0).dot(S.col(1)));
    } else {
      a = T.ToChild(a);
      force[i] = body.mass_kg * a;
      torque[i] = h.cross(a);
    }
  }

  Joints tau;
  Vector3 f = Vector3::Zero(), t = Vector3::Zero();  // on the link, at its origin, from all further out
  for (std::size_t i = N; i-- > 0;) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    f += force[i];
    t += torque[i];
    tau[static_cast<int>(i)] = t.z();
    if constexpr (kMoving)
      tau[static_cast<int>(i)] += params_.joints[i].rotor_inertia_kg_m2 * qdd[static_cast<int>(i)];
    f = T.ToParent(f);
    t = T.ToParent(t) + step.p.cross(f);
  }
  return tau;
}

template <int N>
JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints& q, const Joints& qd,
                                                const Joints& qdd) const noexcept {
  return NewtonEuler<true>(q, qd, qdd, lift_K0_);
}

template <int N>
JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints& q, const Joints& qd, const Joints& qdd,
                                                const Wrench& F_ext_B) const noexcept {
  return NewtonEuler<true>(q, qd, qdd, lift_K0_) - TorquesOf(Place(q), F_ext_B);
}

template <int N>
JointVectorN<N> SerialChain<N>::Gravity(const Joints& q) const noexcept {
  return NewtonEuler<false>(q, Joints::Zero(), Joints::Zero(), lift_K0_);
}

template <int N>
JointVectorN<N> SerialChain<N>::Coriolis(const Joints& q, const Joints& qd) const noexcept {
  return NewtonEuler<true>(q, qd, Joints::Zero(), Vector3::Zero());
}

template <int N>
JointVectorN<N> SerialChain<N>::Friction(const Joints& qd) const noexcept {
  Joints tau;
  for (int i = 0; i < N; ++i) {
    const JointFriction& friction = params_.joints[static_cast<std::size_t>(i)].friction;
    tau[i] = friction.viscous_Nms_per_rad * qd[i] +
             friction.coulomb_Nm * std::tanh(qd[i] / friction.smoothing_rad_per_s);
  }
  return tau;
}

#define OSTEON_INSTANTIATE(N)                                                                           \
  template JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints&, const Joints&, const Joints&) \
      const noexcept;                                                                                   \
  template JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints&, const Joints&, const Joints&, \
                                                           const Wrench&) const noexcept;               \
  template JointVectorN<N> SerialChain<N>::Gravity(const Joints&) const noexcept;                       \
  template JointVectorN<N> SerialChain<N>::Coriolis(const Joints&, const Joints&) const noexcept;       \
  template JointVectorN<N> SerialChain<N>::Friction(const Joints&) const noexcept;
OSTEON_INSTANTIATE(6)
OSTEON_INSTANTIATE(7)
#undef OSTEON_INSTANTIATE

}  // namespace osteon::kinematics
