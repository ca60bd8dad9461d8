#include <cassert>
#include <cmath>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"
#include "kinematics/sin_cos.h"

// Inverse dynamics, link by link. Each link is computed in its own frame, in which its mass properties are
// constant.

namespace osteon::kinematics {
namespace {

// Copies a 3-vector of Eigen's to plain numbers.
template <class V>
[[gnu::always_inline]] inline Triple<double> Copy(const V& v) {
  return {v(0), v(1), v(2)};
}

[[gnu::always_inline]] inline double Dot(const Triple<double>& a, const Triple<double>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Returns the first half of a pair in both halves.
[[gnu::always_inline]] inline Pair Low(Pair v) { return Pair{v[0], v[0]}; }

// Returns the first half of a pair in the second half, and 0 in the first.
[[gnu::always_inline]] inline Pair High(Pair v) { return Pair{0.0, v[0]}; }

}  // namespace

// Newton-Euler: the motion from base to flange, then (Gather) the forces back. A point r of a link
// accelerates by a + A r, where
//
//     A = [wd] + [w][w] = [wd] + w w^T - |w|^2 1
//
// is used three times: for the acceleration of the next link's origin, for the force m a + A h, and for the
// torque about the link's origin. That torque is the integral of r × (a + A r) dm, which is h × a + skew part
// of A S, with the first moment h and the second moments S. Quantities that rotate together share a Pair, one
// in each half: w with wd, force with torque.
template <int N>
JointVectorN<N> SerialChain<N>::NewtonEuler(const Joints& q, const Joints& qd, const Joints& qdd,
                                            const Vector3& a_base) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = SinCosOfTurns(q);
  std::array<Triple<Pair>, static_cast<std::size_t>(N)>
      loads;            // force and torque of each link, at its origin
  Triple<Pair> spin{};  // w and wd
  Triple<double> a{a_base.x(), a_base.y(), a_base.z()};
  Triple<double> x_row{}, y_row{}, z_row{};  // rows of A
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    const Body& body = bodies_[i];
    const Triple<double> p = Copy(step.p), h = Copy(body.first_moment_kg_m);
    a = T.ToChild(a + Triple<double>{Dot(x_row, p), Dot(y_row, p), Dot(z_row, p)});
    spin = T.ToChild(spin);
    // the joint adds z qd to w, and z qdd + w × z qd to wd
    const double rate = qd[static_cast<int>(i)];
    const Pair to_wd{0.0, rate};
    const Triple<Pair> w_both{Low(spin.x), Low(spin.y), Low(spin.z)};
    spin.x += to_wd * w_both.y;
    spin.y -= to_wd * w_both.x;
    spin.z += Pair{rate, qdd[static_cast<int>(i)]};

    const Triple<double> w{spin.x[0], spin.y[0], spin.z[0]}, wd{spin.x[1], spin.y[1], spin.z[1]};
    const double xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
    const double xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
    // A = [wd] + w w^T - |w|^2 1
    x_row = {-yy - zz, xy - wd.z, xz + wd.y};
    y_row = {xy + wd.z, -xx - zz, yz - wd.x};
    z_row = {xz - wd.y, yz + wd.x, -xx - yy};
    // force m a + A h; torque h × a + skew part of A S
    const Matrix3& S = body.second_moment_kg_m2;
    const Triple<double> Sx = Copy(S.col(0)), Sy = Copy(S.col(1)), Sz = Copy(S.col(2));
    const double m = body.mass_kg;
    loads[i] = {Pair{m * a.x + Dot(x_row, h), h.y * a.z - h.z * a.y + Dot(z_row, Sy) - Dot(y_row, Sz)},
                Pair{m * a.y + Dot(y_row, h), h.z * a.x - h.x * a.z + Dot(x_row, Sz) - Dot(z_row, Sx)},
                Pair{m * a.z + Dot(z_row, h), h.x * a.y - h.y * a.x + Dot(y_row, Sx) - Dot(x_row, Sy)}};
  }
  return Gather(turn, loads, qdd);
}

// Goes from the flange to the base, and sums for each joint the loads of all links further out.
template <int N>
JointVectorN<N> SerialChain<N>::Gather(const SinCosN<kPadded>& turn,
                                       const std::array<Triple<Pair>, static_cast<std::size_t>(N)>& loads,
                                       const Joints& qdd) const noexcept {
  Joints tau;
  Triple<Pair> load{};
  for (std::size_t i = N; i-- > 0;) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    load = load + loads[i];
    tau[static_cast<int>(i)] = load.z[1] + params_.joints[i].rotor_inertia_kg_m2 * qdd[static_cast<int>(i)];
    load = T.ToParent(load);
    const Triple<double> p = Copy(step.p);
    load.x += High(p.y * load.z - p.z * load.y);  // torque += p × force
    load.y += High(p.z * load.x - p.x * load.z);
    load.z += High(p.x * load.y - p.y * load.x);
  }
  return tau;
}

// Gravity acts like an upward acceleration of the base. At rest all links have this acceleration; it is
// expressed in each link's frame.
template <int N>
JointVectorN<N> SerialChain<N>::Gravity(const Joints& q) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = SinCosOfTurns(q);
  std::array<Triple<Pair>, static_cast<std::size_t>(N)> loads;
  Triple<double> a = Copy(lift_K0_);
  for (std::size_t i = 0; i < N; ++i) {
    const FrameTurn T{steps_[i].cos_alpha, steps_[i].sin_alpha, turn.cos[i], turn.sin[i]};
    const Triple<double> h = Copy(bodies_[i].first_moment_kg_m);
    const double m = bodies_[i].mass_kg;
    a = T.ToChild(a);
    loads[i] = {Pair{m * a.x, h.y * a.z - h.z * a.y}, Pair{m * a.y, h.z * a.x - h.x * a.z},
                Pair{m * a.z, h.x * a.y - h.y * a.x}};
  }
  return Gather(turn, loads, Joints::Zero());
}

template <int N>
JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints& q, const Joints& qd,
                                                const Joints& qdd) const noexcept {
  return NewtonEuler(q, qd, qdd, lift_K0_);
}

template <int N>
JointVectorN<N> SerialChain<N>::InverseDynamics(const Joints& q, const Joints& qd, const Joints& qdd,
                                                const Wrench& F_ext_B) const noexcept {
  return NewtonEuler(q, qd, qdd, lift_K0_) - TorquesOf(ComputePosture(q), F_ext_B);
}

template <int N>
JointVectorN<N> SerialChain<N>::Coriolis(const Joints& q, const Joints& qd) const noexcept {
  return NewtonEuler(q, qd, Joints::Zero(), Vector3::Zero());
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
