#include <cassert>

#include "kinematics/frame_turn.h"
#include "kinematics/serial_chain.h"

// Forward dynamics by the articulated-body algorithm (ABA).

namespace osteon::kinematics {
namespace {

[[gnu::always_inline]] inline Triple<double> Copy(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

[[gnu::always_inline]] inline Triple<double> CrossOf(const Triple<double>& a, const Triple<double>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

[[gnu::always_inline]] inline double Dot(const Triple<double>& a, const Triple<double>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Returns the vector in one half of the pairs: 0 or 1.
[[gnu::always_inline]] inline Triple<double> Half(const Triple<Pair>& v, int half) {
  return {v.x[half], v.y[half], v.z[half]};
}

// Articulated inertia of a link together with all links further out, whose joints are free to move. If the
// link's origin has the acceleration a and the link the angular acceleration wd, the load at the origin is
//
//     torque = J wd + H a + torque0        force = H^T wd + M a + force0
//
// J and M are rotated in the same way, so they are stored as the two halves of pairs; torque0 and force0 as
// well. H is stored as its symmetric part and the vector of its skew part, because these two can be rotated
// separately.
struct Articulated {
  Symmetric<Pair> JM;
  Symmetric<double> H;
  Triple<double> H_skew;
  Triple<Pair> bias;

  // H's rows.
  [[gnu::always_inline]] std::array<Triple<double>, 3> Rows() const {
    return {{{H.xx, H.xy - H_skew.z, H.xz + H_skew.y},
             {H.xy + H_skew.z, H.yy, H.yz - H_skew.x},
             {H.xz - H_skew.y, H.yz + H_skew.x, H.zz}}};
  }

  // Adds the articulated inertia of the next link, given in that link's frame: it is rotated into this frame,
  // then moved by p. With J, H and M the rotated blocks, the moved ones are H' = H + [p] M and J' = J + [p]
  // G^T + G [p]^T, where G = H + 1/2 [p] M.
  [[gnu::always_inline]] void Add(Articulated child, const FrameTurn& T, const Triple<double>& p) {
    child.JM.ToParent(T);
    child.H.ToParent(T);
    child.H_skew = T.ToParent(child.H_skew);
    child.bias = T.ToParent(child.bias);

    const Symmetric<Pair>& in = child.JM;
    const Triple<double> M_x{in.xx[1], in.xy[1], in.xz[1]}, M_y{in.xy[1], in.yy[1], in.yz[1]},
        M_z{in.xz[1], in.yz[1], in.zz[1]};
    // rows of [p] M
    const std::array<Triple<double>, 3> moved{
        {{p.y * M_z.x - p.z * M_y.x, p.y * M_z.y - p.z * M_y.y, p.y * M_z.z - p.z * M_y.z},
         {p.z * M_x.x - p.x * M_z.x, p.z * M_x.y - p.x * M_z.y, p.z * M_x.z - p.x * M_z.z},
         {p.x * M_y.x - p.y * M_x.x, p.x * M_y.y - p.y * M_x.y, p.x * M_y.z - p.y * M_x.z}}};
    std::array<Triple<double>, 3> G = child.Rows();
    for (std::size_t i = 0; i < 3; ++i)
      G[i] = {G[i].x + 0.5 * moved[i].x, G[i].y + 0.5 * moved[i].y, G[i].z + 0.5 * moved[i].z};
    // column j of [p] G^T is p × row j of G
    const Triple<double> x = CrossOf(p, G[0]), y = CrossOf(p, G[1]), z = CrossOf(p, G[2]);
    JM.xx += in.xx + Pair{2.0 * x.x, 0.0};
    JM.yy += in.yy + Pair{2.0 * y.y, 0.0};
    JM.zz += in.zz + Pair{2.0 * z.z, 0.0};
    JM.xy += in.xy + Pair{x.y + y.x, 0.0};
    JM.xz += in.xz + Pair{x.z + z.x, 0.0};
    JM.yz += in.yz + Pair{y.z + z.y, 0.0};

    H.xx += child.H.xx + moved[0].x;
    H.yy += child.H.yy + moved[1].y;
    H.zz += child.H.zz + moved[2].z;
    H.xy += child.H.xy + 0.5 * (moved[0].y + moved[1].x);
    H.xz += child.H.xz + 0.5 * (moved[0].z + moved[2].x);
    H.yz += child.H.yz + 0.5 * (moved[1].z + moved[2].y);
    H_skew = H_skew + child.H_skew +
             Triple<double>{0.5 * (moved[2].y - moved[1].z), 0.5 * (moved[0].z - moved[2].x),
                            0.5 * (moved[1].x - moved[0].y)};

    const Triple<double> lever = CrossOf(p, Half(child.bias, 1));  // torque of the child's force
    bias = bias + child.bias + Triple<Pair>{Pair{lever.x, 0.0}, Pair{lever.y, 0.0}, Pair{lever.z, 0.0}};
  }
};

}  // namespace

// Accelerations are those of the link's origin and of its rotation, not Featherstone's spatial accelerations.
// A body's bias is the torque w × J w and the force w × (w × h); a joint's bias is the accelerations w × z qd
// and w × (w × p). More than 60 lines, because the three passes of the algorithm share their arrays. Only the
// simulated arm calls this function.
template <int N>
JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints& q, const Joints& qd,
                                                const Joints& tau) const noexcept {
  assert(params_.has_masses);
  const SinCosN<kPadded> turn = SinCosOfTurns(q);
  std::array<Articulated, static_cast<std::size_t>(N)> bodies;
  std::array<Triple<double>, static_cast<std::size_t>(N)> wd_bias, a_bias;
  std::array<Triple<Pair>, static_cast<std::size_t>(N)>
      U;  // torque and force at the link's origin for a unit acceleration of its joint
  // u: the joint's torque minus the bias torque; D: articulated inertia about the joint's axis, plus the
  // rotor's inertia
  std::array<double, static_cast<std::size_t>(N)> u, D;

  // outwards: angular velocity, bias of bodies and joints
  Triple<double> w{};
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    a_bias[i] = T.ToChild(CrossOf(w, CrossOf(w, Copy(step.p))));
    w = T.ToChild(w);
    const double rate = qd[static_cast<int>(i)];
    wd_bias[i] = {w.y * rate, -w.x * rate, 0.0};
    w.z += rate;

    const Body& body = bodies_[i];
    const Matrix3& J = body.inertia_kg_m2;
    const double m = body.mass_kg;
    const Triple<double> h = Copy(body.first_moment_kg_m);
    const Triple<double> angular_momentum{J(0, 0) * w.x + J(0, 1) * w.y + J(0, 2) * w.z,
                                          J(0, 1) * w.x + J(1, 1) * w.y + J(1, 2) * w.z,
                                          J(0, 2) * w.x + J(1, 2) * w.y + J(2, 2) * w.z};
    const Triple<double> torque = CrossOf(w, angular_momentum), force = CrossOf(w, CrossOf(w, h));
    bodies[i].JM = {Pair{J(0, 0), m},   Pair{J(1, 1), m},   Pair{J(2, 2), m},
                    Pair{J(0, 1), 0.0}, Pair{J(0, 2), 0.0}, Pair{J(1, 2), 0.0}};
    bodies[i].H = {};
    bodies[i].H_skew = h;
    bodies[i].bias = {Pair{torque.x, force.x}, Pair{torque.y, force.y}, Pair{torque.z, force.z}};
  }

  // inwards: the part of a body's inertia that its parent feels through the free joint
  for (std::size_t i = N; i-- > 0;) {
    Articulated& body = bodies[i];
    const Symmetric<Pair>& in = body.JM;
    U[i] = {Pair{in.xz[0], body.H.xz - body.H_skew.y}, Pair{in.yz[0], body.H.yz + body.H_skew.x},
            Pair{in.zz[0], body.H.zz}};
    D[i] = in.zz[0] + params_.joints[i].rotor_inertia_kg_m2;
    u[i] = tau[static_cast<int>(i)] - body.bias.z[0];
    if (i == 0) break;
    const double inverse = 1.0 / D[i];
    // V = U / D; the free joint reduces the inertia by U V^T
    const Triple<Pair> V{inverse * U[i].x, inverse * U[i].y, inverse * U[i].z};
    body.JM.xx -= U[i].x * V.x;
    body.JM.yy -= U[i].y * V.y;
    body.JM.zz -= U[i].z * V.z;
    body.JM.xy -= U[i].x * V.y;
    body.JM.xz -= U[i].x * V.z;
    body.JM.yz -= U[i].y * V.z;
    // H is reduced by torque force^T / D (torque and force: the halves of U); the vector of its skew part is
    // force × torque / (2 D)
    const Triple<double> t = Half(U[i], 0), f = Half(V, 1), skew = CrossOf(f, t);
    body.H.xx -= t.x * f.x;
    body.H.yy -= t.y * f.y;
    body.H.zz -= t.z * f.z;
    body.H.xy -= 0.5 * (t.x * f.y + t.y * f.x);
    body.H.xz -= 0.5 * (t.x * f.z + t.z * f.x);
    body.H.yz -= 0.5 * (t.y * f.z + t.z * f.y);
    body.H_skew = {body.H_skew.x - 0.5 * skew.x, body.H_skew.y - 0.5 * skew.y, body.H_skew.z - 0.5 * skew.z};

    // bias that the parent feels: the reduced inertia times the joint's bias accelerations, plus u V
    const std::array<Triple<double>, 3> H = body.Rows();
    const Triple<double>&wd = wd_bias[i], &a = a_bias[i];
    const Triple<Pair> both{Pair{wd.x, a.x}, Pair{wd.y, a.y}, Pair{wd.z, a.z}};
    body.bias.x += in.xx * both.x + in.xy * both.y + in.xz * both.z + u[i] * V.x +
                   Pair{Dot(H[0], a), H[0].x * wd.x + H[1].x * wd.y + H[2].x * wd.z};
    body.bias.y += in.xy * both.x + in.yy * both.y + in.yz * both.z + u[i] * V.y +
                   Pair{Dot(H[1], a), H[0].y * wd.x + H[1].y * wd.y + H[2].y * wd.z};
    body.bias.z += in.xz * both.x + in.yz * both.y + in.zz * both.z + u[i] * V.z +
                   Pair{Dot(H[2], a), H[0].z * wd.x + H[1].z * wd.y + H[2].z * wd.z};

    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    bodies[i - 1].Add(body, T, Copy(step.p));
  }

  // outwards: accelerations
  Joints qdd;
  Triple<double> wd{}, a = Copy(lift_K0_);
  for (std::size_t i = 0; i < N; ++i) {
    const Step& step = steps_[i];
    const FrameTurn T{step.cos_alpha, step.sin_alpha, turn.cos[i], turn.sin[i]};
    a = T.ToChild(a + CrossOf(wd, Copy(step.p))) + a_bias[i];
    wd = T.ToChild(wd) + wd_bias[i];
    const double joint_acceleration = (u[i] - Dot(Half(U[i], 0), wd) - Dot(Half(U[i], 1), a)) / D[i];
    wd.z += joint_acceleration;
    qdd[static_cast<int>(i)] = joint_acceleration;
  }
  return qdd;
}

template <int N>
JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints& q, const Joints& qd, const Joints& tau,
                                                const Wrench& F_ext_B) const noexcept {
  return ForwardDynamics(q, qd, tau + TorquesOf(ComputePosture(q), F_ext_B));
}

#define OSTEON_INSTANTIATE(N)                                                                           \
  template JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints&, const Joints&, const Joints&) \
      const noexcept;                                                                                   \
  template JointVectorN<N> SerialChain<N>::ForwardDynamics(const Joints&, const Joints&, const Joints&, \
                                                           const Wrench&) const noexcept;
OSTEON_INSTANTIATE(6)
OSTEON_INSTANTIATE(7)
#undef OSTEON_INSTANTIATE

}  // namespace osteon::kinematics
